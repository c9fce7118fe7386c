"""Rendering of a solid as an RGB-D camera sees it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Camera, FloatArray, View
from al_questioner.simulation.kitchen.drawing.depth_sensor import measure_depth
from al_questioner.simulation.kitchen.drawing.geometry import Solid, Stack
from al_questioner.simulation.kitchen.drawing.images import blurred, merged, planes, resized
from al_questioner.simulation.kitchen.drawing.projection import FINE, SHIFT, Pose, Projection
from al_questioner.simulation.kitchen.drawing.shading import Painting, Surface, shade
from al_questioner.simulation.kitchen.drawing.texture import TABLE_TILE_M, noise_tile, table_top, table_top_count
from al_questioner.simulation.task import AppearanceParameters, CameraParameters

FRAME = (640, 480)
"""Width and height of the camera's frame in pixels."""

_WANDER_PX = 100
"""Largest distance of an object's middle from the frame's centre, in pixels, since the robot does not aim exactly."""


@dataclass(frozen=True, eq=False)
class Lighting:
    """Direction and colour of the light, and the table top under the object.

    Attributes:
        toward: (3,) unit vector to the light in the camera's heading: x right, y away, z up.
        gains: (3,) of red, green and blue.
        table: index of the table top.
    """

    toward: FloatArray
    gains: FloatArray
    table: int


def draw_pose(rng: np.random.Generator, solid: Solid, size: float, camera: CameraParameters) -> Pose:
    """Draw a random pose of an object within the task's ranges, well inside the frame."""
    return Pose(
        size=size,
        heading=float(np.deg2rad(rng.uniform(*solid.turn_deg))),
        distance=float(rng.uniform(*camera.distance_m)),
        elevation=float(np.deg2rad(rng.uniform(*camera.elevation_deg))),
        offset_px=(float(rng.uniform(-_WANDER_PX, _WANDER_PX)), float(rng.uniform(-_WANDER_PX, _WANDER_PX))),
    )


def draw_lighting(rng: np.random.Generator, looks: AppearanceParameters) -> Lighting:
    """Draw a random light within the task's ranges, from the side or from behind the camera."""
    height = np.deg2rad(rng.uniform(*looks.light_elevation_deg))
    bearing = rng.uniform(-0.85 * np.pi, -0.15 * np.pi)
    toward = np.array([np.cos(height) * np.cos(bearing), np.cos(height) * np.sin(bearing), np.sin(height)])
    gains = np.exp(rng.normal(0, looks.light_spread) + rng.normal(0, looks.tint_spread, 3))
    table = int(rng.integers(table_top_count())) if rng.random() < looks.background_variety else 0
    return Lighting(toward.astype(np.float32), gains.astype(np.float32), table)


def render(solid: Solid, pose: Pose, lighting: Lighting, camera: CameraParameters, rng: np.random.Generator) -> View:
    """Render the crop of the frame that shows a solid on the table.

    Colour, depth and mask agree with the pinhole model of `View.camera`: the size in metres that the mask and the depth
    readings give is the solid's size.
    """
    intrinsics = Camera(camera.focal_px, camera.focal_px, (FRAME[0] - 1) / 2, (FRAME[1] - 1) / 2)
    projection, placed, polygons = Projection.around(solid, pose, intrinsics, camera.margin_px)
    surface = Surface.of(_paint(solid.stacks, placed, polygons, projection), solid.materials)
    points = projection.unproject(surface.relief)
    picture = _table_picture(solid.stacks, placed, lighting, projection, rng)
    glare = shade(picture, surface, points, lighting.toward, projection, rng)

    mask = surface.coverage > 0.5
    color = _photograph(merged(picture), lighting, camera, rng)
    # The bare table lies equally deep along a row.
    table = projection.unproject(np.zeros((len(mask), 1), dtype=np.float32))[2]
    depth = measure_depth(points[2], np.broadcast_to(table, mask.shape), mask, glare, camera, rng)
    return View(color=color, depth=depth, mask=mask, camera=intrinsics, origin=projection.origin)


def _photograph(
    picture: FloatArray, lighting: Lighting, camera: CameraParameters, rng: np.random.Generator
) -> NDArray[np.uint8]:
    """Return the (rows, columns, 3) blue-green-red photograph of a picture in red, green and blue from 0 to 1."""
    if camera.blur_px > 0:
        picture = blurred(picture, camera.blur_px)
    height, width = picture.shape[:2]
    gains = np.broadcast_to(255 * lighting.gains, (width, 3))
    tile = noise_tile()
    row, column = rng.integers(0, tile.shape[0] - height), rng.integers(0, tile.shape[1] - width)
    exposed = picture.reshape(height, -1) * gains.ravel()
    exposed += np.float32(camera.color_noise) * tile[row : row + height, column : column + width].reshape(height, -1)
    levels = np.clip(exposed, 0, 255, out=exposed).astype(np.uint8).reshape(height, width, 3)
    return np.asarray(cv2.cvtColor(levels, cv2.COLOR_RGB2BGR), dtype=np.uint8)


def _paint(
    stacks: Sequence[Stack], placed: Sequence[FloatArray], pixels: Sequence[NDArray[np.int32]], projection: Projection
) -> Painting:
    """Paint the polygons in order; each fine pixel keeps the number of the last polygon that covers it."""
    canvas = np.zeros((FINE * projection.shape[0], FINE * projection.shape[1]), dtype=np.int32)
    heights: list[FloatArray] = [np.zeros(1, np.float32)]
    tones: list[FloatArray] = [np.ones(1, np.float32)]
    parts = [np.zeros(1, np.intp)]
    painted = 1
    for stack, points, polygons in zip(stacks, placed, pixels, strict=True):
        heights.append(points[..., 2].mean(axis=1) + np.float32(0.5 * stack.stroke * projection.pose.size))
        parts.append(np.full(len(points), stack.part))
        tones.append(stack.tones)
        if stack.opening is None:
            _paint_stack(canvas, polygons, painted, stack, projection)
        else:
            rim = projection.pixels(projection.place(stack.opening))
            corner = np.maximum(rim.min(axis=0) >> SHIFT, 0)
            columns, rows = (rim.max(axis=0) >> SHIFT) + 2
            window = canvas[corner[1] : rows, corner[0] : columns]
            inside = window.copy()
            hole = np.zeros(window.shape, dtype=np.uint8)
            offset = (corner << SHIFT).astype(np.int32)
            _paint_stack(inside, polygons - offset, painted, stack, projection)
            cv2.fillConvexPoly(hole, rim - offset, 1, cv2.LINE_8, SHIFT)
            cv2.copyTo(inside, hole, window)
        painted += len(points)
    return Painting(canvas, np.concatenate(heights), np.concatenate(parts), np.concatenate(tones))


def _paint_stack(
    canvas: NDArray[np.int32], polygons: NDArray[np.int32], first: int, stack: Stack, projection: Projection
) -> None:
    width = max(1, round(stack.stroke * projection.pose.size * projection.scale * FINE))
    for number, polygon in enumerate(polygons, first):
        if stack.stroke:
            cv2.polylines(canvas, [polygon], False, number, width, cv2.LINE_8, SHIFT)
        elif stack.convex:
            cv2.fillConvexPoly(canvas, polygon, number, cv2.LINE_8, SHIFT)
        else:
            cv2.fillPoly(canvas, [polygon], number, cv2.LINE_8, SHIFT)


def _table_picture(
    stacks: Sequence[Stack],
    placed: Sequence[FloatArray],
    lighting: Lighting,
    projection: Projection,
    rng: np.random.Generator,
) -> FloatArray:
    """Return (3, rows, columns) the lit table with the object's shadow, before the object itself."""
    rows, columns = projection.shape
    tile = table_top(lighting.table)
    height = min(int(np.ceil(rows / projection.scale / projection.sine / TABLE_TILE_M)) + 1, tile.shape[0])
    width = min(int(np.ceil(columns / projection.scale / TABLE_TILE_M)) + 1, tile.shape[1])
    row, column = rng.integers(0, tile.shape[0] - height + 1), rng.integers(0, tile.shape[1] - width + 1)
    patch = tile[row : row + height, column : column + width]
    picture = planes(resized(patch, (columns, rows)))

    shadow: FloatArray = np.zeros((rows // 2 + 1, columns // 2 + 1), dtype=np.float32)
    slope = lighting.toward[:2] / lighting.toward[2]
    casts = []
    for stack, points in zip(stacks, placed, strict=True):
        if stack.opening is None and not stack.stroke:
            cast = points[:: max(1, len(points) // 6)].copy()
            cast[..., :2] -= slope * cast[..., 2:]
            cast[..., 2] = 0
            casts.append(cast)
    for polygons in projection.pixels_of_all(casts, 0.5):
        for polygon in polygons:
            cv2.fillPoly(shadow, [polygon], 1.0, shift=SHIFT)
    near, far = blurred(shadow, 1.1, 2), blurred(shadow, 2.6, 5)
    shadow = resized(near + far, (columns, rows))
    picture *= 1 - 0.26 * shadow
    return picture
