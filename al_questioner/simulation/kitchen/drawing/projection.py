"""Pinhole camera that looks down at one object on the table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Camera, FloatArray
from al_questioner.simulation.kitchen.drawing.geometry import Solid, turned

Number = TypeVar('Number', bound=np.generic)

FINE = 2
"""Factor by which the painting grid is finer than the crop's pixels, for smooth edges."""

SHIFT = 4
"""Number of fractional bits of painted coordinates."""


@dataclass(frozen=True)
class Pose:
    """Position of a solid before the camera.

    Attributes:
        size: factor of the solid's lengths.
        heading: its rotation about the vertical axis, radians.
        distance: distance of its middle along the optical axis, metres.
        elevation: elevation of the camera above the table plane, radians.
        offset_px: (right, up) of its middle from the frame's centre.
    """

    size: float
    heading: float
    distance: float
    elevation: float
    offset_px: tuple[float, float]


@dataclass(frozen=True, eq=False)
class Projection:
    """Mapping from points on the table, relative to the object, to the pixels of a crop, and back.

    With the camera's elevation e, the object's middle at height m, and the camera's axes right, up and forward, a point
    (x, y, z) lies at (a + x, b + y sin e + (z - m) cos e, d + y cos e - (z - m) sin e).

    Attributes:
        camera: intrinsics of the frame.
        pose: position of the solid.
        middle: m, metres.
        origin: column and row of the crop's first pixel in the frame.
        shape: rows and columns of the crop.
    """

    camera: Camera
    pose: Pose
    middle: float
    origin: tuple[int, int] = (0, 0)
    shape: tuple[int, int] = (0, 0)

    @classmethod
    def around(
        cls, solid: Solid, pose: Pose, camera: Camera, margin_px: int
    ) -> tuple[Projection, list[FloatArray], list[NDArray[np.int32]]]:
        """Return the projection to the crop that shows a solid with a margin.

        Returns:
            The projection; the polygons of each of the solid's stacks placed on the table, (n, k, 3) metres; and where
            they lie in the crop, (n, k, 2) as from `pixels`.
        """
        corners = np.concatenate([stack.polygons.reshape(-1, 3) for stack in solid.stacks])
        corners = turned(corners, pose.heading) * np.float32(pose.size)
        whole = cls(camera, pose, float(corners[:, 2].max()) / 2)
        columns, rows = whole._frame(corners)
        left, top = int(np.floor(columns.min())) - margin_px, int(np.floor(rows.min())) - margin_px
        shape = int(np.ceil(rows.max())) + margin_px + 1 - top, int(np.ceil(columns.max())) + margin_px + 1 - left
        crop = cls(camera, pose, whole.middle, (left, top), shape)
        shapes = [stack.polygons.shape[:-1] for stack in solid.stacks]
        return crop, _split(corners, shapes), _split(crop._fixed_point(columns, rows, FINE), shapes)

    @property
    def scale(self) -> float:
        """Pixels per metre at the object's middle."""
        return self.camera.fx / self.pose.distance

    @property
    def sine(self) -> float:
        """Sine of the camera's elevation."""
        return float(np.sin(self.pose.elevation))

    @property
    def cosine(self) -> float:
        """Cosine of the camera's elevation."""
        return float(np.cos(self.pose.elevation))

    def place(self, points: FloatArray) -> FloatArray:
        """Return points (..., 3) of the solid's own frame, on the table."""
        return turned(points, self.pose.heading) * np.float32(self.pose.size)

    def own(self, x: FloatArray, y: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return points on the table in the solid's own frame and size."""
        size, heading = self.pose.size, self.pose.heading
        c, s = np.float32(np.cos(heading) / size), np.float32(np.sin(heading) / size)
        return c * x + s * y, c * y - s * x, z / np.float32(size)

    def pixels(self, points: FloatArray, fine: float = FINE) -> NDArray[np.int32]:
        """Return (..., 2) fixed-point pixels, on a grid `fine` times finer, of points (..., 3) on the table."""
        return self._fixed_point(*self._frame(points), fine)

    def pixels_of_all(self, polygons: Sequence[FloatArray], fine: float = FINE) -> list[NDArray[np.int32]]:
        """Return `pixels` of many arrays at once, which is faster than one by one."""
        together = np.concatenate([some.reshape(-1, 3) for some in polygons])
        return _split(self.pixels(together, fine), [some.shape[:-1] for some in polygons])

    def unproject(self, relief: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the points on the table that the pixels show, given their (rows, columns) height in metres.

        Returns:
            (rows, columns) x and y of the visible point, and its depth along the optical axis, in metres.
        """
        rows = np.arange(self.shape[0], dtype=np.float32)[:, None] + self.origin[1]
        columns = np.arange(self.shape[1], dtype=np.float32) + self.origin[0]
        up, right = (self.camera.cy - rows) / self.camera.fy, (columns - self.camera.cx) / self.camera.fx
        across, above = self._offset()
        lift = relief - np.float32(self.middle)
        y = up * (self.pose.distance - lift * self.sine) - above - lift * self.cosine
        y /= self.sine - up * self.cosine
        depth = self.pose.distance + y * self.cosine - lift * self.sine
        return right * depth - across, y, depth

    def _frame(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return columns and rows in the frame of points (..., 3) on the table; a pixel's centre is a whole number."""
        across, above = self._offset()
        lift = points[..., 2] - np.float32(self.middle)
        depth = points[..., 1] * self.cosine - lift * self.sine + self.pose.distance
        columns = self.camera.cx + self.camera.fx * (points[..., 0] + across) / depth
        rows = self.camera.cy - self.camera.fy * (points[..., 1] * self.sine + lift * self.cosine + above) / depth
        return columns, rows

    def _offset(self) -> tuple[float, float]:
        right, up = self.pose.offset_px
        return right * self.pose.distance / self.camera.fx, up * self.pose.distance / self.camera.fy

    def _fixed_point(self, columns: FloatArray, rows: FloatArray, fine: float) -> NDArray[np.int32]:
        """Return (..., 2) fixed-point pixels of the crop, see `pixels`, from columns and rows (...) of the frame."""
        flat = np.empty((*columns.shape, 2), dtype=np.int32)
        for i, (frame, first) in enumerate(zip((columns, rows), self.origin, strict=True)):
            exact = frame + (np.float32(0.5) - np.float32(first))
            exact *= fine
            exact -= np.float32(0.5)
            exact *= 1 << SHIFT
            flat[..., i] = np.rint(exact)
        return flat


def _split(points: NDArray[Number], shapes: Sequence[tuple[int, ...]]) -> list[NDArray[Number]]:
    """Return rows (n, d) split into arrays (*shape, d)."""
    dealt, first = [], 0
    for shape in shapes:
        last = first + math.prod(shape)
        dealt.append(points[first:last].reshape(*shape, -1))
        first = last
    return dealt
