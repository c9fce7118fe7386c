"""Light on a surface: computation of a pixel's colour from its height, material and tone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.images import blurred, planes, resized
from al_questioner.simulation.kitchen.drawing.projection import FINE, Projection
from al_questioner.simulation.kitchen.drawing.texture import Decal, Material, grain_tile


@dataclass(frozen=True, eq=False)
class Painting:
    """Numbers of the painted polygons that the fine pixels show, of N; number 0 is the table.

    Attributes:
        numbers: (FINE h, FINE w) polygon.
        heights, parts, tones: (N,) height in metres, number of the material (from 1) and brightness of each polygon.
    """

    numbers: NDArray[np.int32]
    heights: FloatArray
    parts: NDArray[np.intp]
    tones: FloatArray


@dataclass(frozen=True, eq=False)
class Surface:
    """Visible surface of an object in the pixels of a crop.

    Attributes:
        coverage: (h, w) share of the pixel that the object covers.
        relief: (h, w) height of the visible point in metres; beyond the object's edge, the height at the edge.
        color: (3, h, w) colour under even light, without printed pictures, times the coverage.
        tone: (h, w) factor of the brightness of printed pictures.
        part: (h, w) index of the material, -1 for the table.
        materials: the materials.
    """

    coverage: FloatArray
    relief: FloatArray
    color: FloatArray
    tone: FloatArray
    part: NDArray[np.intp]
    materials: Sequence[Material]

    @classmethod
    def of(cls, painting: Painting, materials: Sequence[Material]) -> Surface:
        """Return the surface of a painting, by averaging the fine pixels."""
        numbers = painting.numbers
        size = numbers.shape[1] // FINE, numbers.shape[0] // FINE
        table = np.zeros((len(painting.heights), 4), dtype=np.float32)
        colors = np.array([(0, 0, 0), *(m.color for m in materials)], dtype=np.float32)
        table[:, :3] = colors[painting.parts] * painting.tones[:, None]
        table[:, 3] = painting.heights
        coarse = planes(resized(table.take(numbers, axis=0), size, cv2.INTER_AREA))
        coverage = resized((numbers > 0).astype(np.float32), size, cv2.INTER_AREA)
        heights = blurred(coarse[3], 0.9, 2)
        relief = heights / np.maximum(blurred(coverage, 0.9, 2), 1e-3)
        # The last painted of the four fine pixels lies in front.
        front = np.maximum(numbers[::2, ::2], numbers[1::2, 1::2])
        tone, part = painting.tones.take(front), painting.parts.take(front) - 1
        return cls(coverage, relief, coarse[:3], tone, part, materials)


def shade(
    picture: FloatArray,
    surface: Surface,
    points: tuple[FloatArray, FloatArray, FloatArray],
    light: FloatArray,
    projection: Projection,
    rng: np.random.Generator,
) -> FloatArray:
    """Paint the lit object into the picture of the table: diffuse light, sky light, highlights (Blinn 1977).

    Args:
        picture: (3, h, w) the table; changed in place.
        surface: the object.
        points: (h, w) x, y and depth of the visible points, from `Projection.unproject`.
        light: (3,) unit vector to the light.
        projection: the camera.
        rng: places the grain.

    Returns:
        (h, w) in [0, 1]: disturbance of a depth sensor by highlights and transparency.
    """
    at = np.flatnonzero((surface.coverage > 0) & (surface.part >= 0))
    part, coverage = surface.part.take(at), surface.coverage.take(at)
    x, y, z = points[0].take(at), points[1].take(at), surface.relief.take(at)
    normal = _normals(surface.relief, projection, at)
    halfway = light + np.array([0, -projection.cosine, projection.sine], dtype=np.float32)
    halfway /= np.linalg.norm(halfway)
    shine, sharpness, grain, fineness, clear = (
        np.array(values, dtype=np.float32)
        for values in zip(
            *((m.shine, m.sharpness, m.grain, 12 / m.grain_m, m.clear) for m in surface.materials), strict=True
        )
    )

    lit = 0.42 + 0.13 * normal[2] + 0.55 * np.maximum(light @ normal, 0)
    lit *= 0.86 + 0.14 * np.minimum(z / 0.02, 1)
    tile, shift = grain_tile(), rng.integers(0, 512, 2)
    fine = fineness.take(part)
    across = ((x + 0.3 * y) * fine).astype(np.intp) + shift[0] & 511
    along = ((0.9 * y + z) * fine).astype(np.intp) + shift[1] & 511
    lit *= 1 + grain.take(part) * tile.take(along * 512 + across)
    colors = surface.color.reshape(3, -1).take(at, axis=1) / np.maximum(coverage, 1e-3)
    for index, material in enumerate(surface.materials):
        if material.decal is not None:
            here = np.flatnonzero(part == index)
            printed = decal_colors(material.decal, *projection.own(x[here], y[here], z[here]))
            colors[:, here] = printed.T * surface.tone.take(at[here])
    colors *= lit

    table = picture.reshape(3, -1).take(at, axis=1)
    glare = np.zeros(projection.shape, dtype=np.float32)
    if clear.any():
        through = clear.take(part)
        colors += through * (table * 0.92 + 0.04 - colors)
        glare.ravel()[at] = through
    mirror = halfway @ normal
    bright = np.flatnonzero(mirror > 0.7)
    glint = shine.take(part[bright]) * mirror[bright] ** sharpness.take(part[bright])
    colors[:, bright] += glint
    glare.ravel()[at[bright]] = np.maximum(glare.ravel()[at[bright]], np.minimum(1.6 * glint, 1))
    for plane, values in zip(picture, table + coverage * (colors - table), strict=True):
        plane.ravel()[at] = values
    return glare


def _normals(relief: FloatArray, projection: Projection, at: NDArray[np.intp]) -> FloatArray:
    """Return (3, n) unit normals of the surface whose height over the picture is `relief`.

    Perspective is neglected over one pixel: with picture coordinates u to the right and v up, in metres, the surface is
    (u, (v - z cos e) / sin e, z(u, v)); the normal is the cross product of its two derivatives.
    """
    du = cv2.Sobel(relief, cv2.CV_32F, 1, 0, ksize=3, scale=projection.scale / 8).take(at)
    dv = cv2.Sobel(relief, cv2.CV_32F, 0, 1, ksize=3, scale=-projection.scale / 8).take(at)
    normal = np.empty((3, len(at)), dtype=np.float32)
    normal[0] = du / -projection.sine
    normal[1] = -dv
    normal[2] = (1 - dv * projection.cosine) / projection.sine
    normal /= np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    return normal


def decal_colors(decal: Decal, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Return (n, 3) colours of a printed picture at n points of the surface, in the solid's own frame."""
    rows, columns = decal.image.shape[:2]
    if decal.mapping == 'top':
        u, v = x / decal.size[0] + 0.5, 0.5 - y / decal.size[1]
    else:
        low, high = decal.size
        v = (high - z) / (high - low)
        if decal.mapping == 'wrap':
            u = np.arctan2(y, x) / (2 * np.pi) + 0.5
        else:
            u = _around_box(x / decal.half[0], y / decal.half[1])
    across = np.clip(u * columns, 0, columns - 1).astype(np.float32)
    down = np.clip(v * rows, 0, rows - 1).astype(np.float32)
    colors = cv2.remap(decal.image, across[:, None], down[:, None], cv2.INTER_LINEAR)
    return np.asarray(colors, dtype=np.float32).reshape(-1, 3)


def _around_box(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the position in [0, 1) along the walls of the square [-1, 1]^2, a quarter a wall."""
    side = np.abs(x) > np.abs(y)
    wall = np.where(side, np.where(x > 0, 0, 2), np.where(y > 0, 1, 3))
    along = np.where(side, np.where(x > 0, y, -y), np.where(y > 0, -x, x))
    return ((wall + np.clip((along + 1) / 2, 0, 0.999)) / 4).astype(np.float32)
