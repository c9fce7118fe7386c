"""Solids as stacks of slices: the shape of an object, before a camera sees it.

A solid is a list of flat polygons with the height at which each lies. Seen obliquely from above, a higher polygon hides
a lower one, so that painting them in order gives the visible height of every pixel: colour, depth and mask of a view
all come from that one height map, and agree. Lengths are in metres, z is up, the object stands on z = 0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.texture import Material

Point = tuple[float, float]

SPACING = 0.004
"""Distance of two slices, in metres: little more than one pixel of a view."""


@dataclass(frozen=True, eq=False)
class Stack:
    """Polygons of one material, painted in order.

    Attributes:
        polygons: (n, k, 3) corners.
        part: index of the material.
        tones: (n,) factors of the material's brightness.
        convex: every polygon is convex.
        opening: (k, 3) polygon through which the stack is seen, such as the rim of a vessel; or None.
        stroke: 0 to fill the polygons; otherwise they are open lines of this width in metres.
    """

    polygons: FloatArray
    part: int
    tones: FloatArray
    convex: bool = True
    opening: FloatArray | None = None
    stroke: float = 0.0


@lru_cache(maxsize=16)
def unit_circle(corners: int = 28) -> FloatArray:
    """Return (corners, 2) points on the circle of radius 1."""
    angles = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    return np.stack([np.cos(angles), np.sin(angles)], axis=1).astype(np.float32)


def resample(profile: ArrayLike, spacing: float = SPACING) -> FloatArray:
    """Return points along a polyline (k, d), at most `spacing` apart, both ends included."""
    points = np.asarray(profile, dtype=float)
    lengths = np.zeros(len(points))
    np.sqrt(((points[1:] - points[:-1]) ** 2).sum(axis=1)).cumsum(out=lengths[1:])
    steps = np.linspace(0, lengths[-1], max(2, math.ceil(lengths[-1] / spacing) + 1))
    along = np.empty((len(steps), points.shape[1]), dtype=np.float32)
    for axis in range(points.shape[1]):
        along[:, axis] = np.interp(steps, lengths, points[:, axis])
    return along


def rounded_rectangle(width: float, depth: float, radius: float) -> FloatArray:
    """Return the (k, 2) outline of a rectangle around the origin with rounded corners."""
    radius = min(radius, width / 2, depth / 2)
    circle = unit_circle(16)
    inner = np.array([width / 2 - radius, depth / 2 - radius], dtype=np.float32)
    quadrant = np.where(np.abs(circle) < 1e-6, 1, np.sign(circle))
    return (circle * radius + quadrant * inner).astype(np.float32)


def turned(points: ArrayLike, angle: float) -> FloatArray:
    """Return points (..., 2) or (..., 3) rotated about the vertical axis."""
    points = np.array(points, dtype=np.float32)
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0].copy(), points[..., 1].copy()
    points[..., 0], points[..., 1] = c * x - s * y, s * x + c * y
    return points


def ball_profile(radius: float, height: float, low: float = 0.0, waist: float = 0.5) -> FloatArray:
    """Return (k, 2) heights and radii of a ball-like body whose widest circle lies at `waist` of its height."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, 24)
    up = np.sin(angles)
    z = np.where(up < 0, waist * (1 + up), waist + (1 - waist) * up) * height + low
    return np.stack([z, radius * np.cos(angles)], axis=1).astype(np.float32)


@dataclass(eq=False)
class Solid:
    """An object that is built piece by piece; each method adds a piece in front of, or above, the pieces before it.

    Attributes:
        turn_deg: range of headings, in degrees, from which the object may be seen.
    """

    stacks: list[Stack] = field(default_factory=list)
    materials: list[Material] = field(default_factory=list)
    turn_deg: tuple[float, float] = (0.0, 360.0)
    _opening: FloatArray | None = None

    @contextmanager
    def inside(self, height: float, radius: float, outline: FloatArray | None = None) -> Iterator[None]:
        """Add pieces that are only seen through a rim of this height and radius (factor of the outline)."""
        rim = np.array([[height, radius]], dtype=np.float32)
        self._opening = self._rings(rim, unit_circle() if outline is None else outline, (0, 0))[0]
        yield
        self._opening = None

    def material(self, material: Material) -> int:
        """Add a material and return its part number."""
        self.materials.append(material)
        return len(self.materials)

    def slices(
        self, polygons: ArrayLike, part: int, tone: ArrayLike = 1.0, *, convex: bool = True, stroke: float = 0.0
    ) -> None:
        """Add polygons (n, k, 3) as they are, or open lines of the width `stroke`."""
        corners = np.asarray(polygons, dtype=np.float32)
        tones = np.full(len(corners), tone, dtype=np.float32)
        self.stacks.append(Stack(corners, part, tones, convex, self._opening, stroke))

    def lathe(
        self,
        profile: ArrayLike,
        part: int,
        *,
        center: Point = (0, 0),
        outline: FloatArray | None = None,
        tone: float = 1.0,
    ) -> None:
        """Add a body whose cross-section, a circle or `outline` (k, 2), keeps its shape over the height.

        Args:
            profile: (n, 2) heights and radii (factors of the outline's size), in the order of painting.
            part: the material.
            center: axis of the body.
            outline: cross-section; None for the unit circle.
            tone: brightness.
        """
        spacing = SPACING if outline is None else SPACING / max(1.0, float(np.abs(profile).max()))
        rings = resample(profile, spacing)
        self.slices(self._rings(rings, unit_circle() if outline is None else outline, center), part, tone)

    @staticmethod
    def _rings(rings: FloatArray, shape: FloatArray, center: Point) -> FloatArray:
        polygons = np.empty((len(rings), len(shape), 3), dtype=np.float32)
        polygons[..., :2] = rings[:, 1, None, None] * shape + np.asarray(center, dtype=np.float32)
        polygons[..., 2] = rings[:, 0, None]
        return polygons

    def box(
        self,
        size: tuple[float, float, float],
        part: int,
        *,
        low: float = 0.0,
        radius: float = 0.003,
        lid: int | None = None,
    ) -> None:
        """Add an upright box; `lid` is the material of its top, if different."""
        width, depth, height = size
        outline = rounded_rectangle(width, depth, radius)
        self.lathe([(low, 1), (low + height, 1)], part, outline=outline)
        if lid is not None:
            top = np.full((len(outline), 3), low + height + 1e-4, dtype=np.float32)
            top[:, :2] = outline
            self.slices(top[None], lid)

    def ball(
        self,
        radius: float,
        height: float,
        part: int,
        *,
        center: Point = (0, 0),
        low: float = 0.0,
        outline: FloatArray | None = None,
        tone: float = 1.0,
        waist: float = 0.5,
    ) -> None:
        """Add a ball-like body; with an outline, `radius` is a factor of its size. `waist` 0 gives a dome."""
        profile = ball_profile(radius, height, low, waist)
        self.lathe(profile, part, center=center, outline=outline, tone=tone)

    def tube(
        self, path: ArrayLike, radius: ArrayLike, part: int, *, low: float = 0.0, flat: float = 1.0, tone: float = 1.0
    ) -> None:
        """Add a lying body of round section along a path.

        Args:
            path: (k, 2) centre line.
            radius: one radius, or one for each of the k points.
            part: the material.
            low: height of the ground it lies on.
            flat: height of the section relative to its width.
            tone: brightness.
        """
        points = np.asarray(path, dtype=np.float32)
        radii = np.broadcast_to(np.asarray(radius, dtype=np.float32), len(points))
        tangents = np.gradient(points, axis=0)
        normals = np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
        largest = float(radii.max())
        count = max(4, int(np.ceil(2 * largest * flat / SPACING)))
        levels = np.sin(np.linspace(-np.pi / 2, np.pi / 2, count + 1)[1:-1]) * largest
        # At each level the tube begins and ends where it is wide enough to reach it.
        reached = radii >= np.abs(levels)[:, None]
        first, last = reached.argmax(axis=1), len(points) - 1 - reached[:, ::-1].argmax(axis=1)
        along = np.clip(np.arange(len(points)), first[:, None], last[:, None])
        width = np.sqrt(np.maximum(radii[along] ** 2 - levels[:, None] ** 2, 0))
        middles, sides = points[along], normals[along] * width[..., None]
        polygons = np.empty((len(levels), 2 * len(points), 3), dtype=np.float32)
        polygons[:, : len(points), :2] = middles + sides
        polygons[:, len(points) :, :2] = (middles - sides)[:, ::-1]
        polygons[..., 2] = (low + (levels + largest) * flat)[:, None]
        self.slices(polygons, part, tone, convex=False)

    def strand(self, points: ArrayLike, radius: float, part: int, *, tone: float = 1.0) -> None:
        """Add a thin round body along a curve (k, 3) in space: a handle, stem or straw."""
        beads = resample(points, 0.004)
        self.slices(np.stack([beads[:-1], beads[1:]], axis=1), part, tone, stroke=2 * radius)

    def plate(self, outline: ArrayLike, height: float, part: int, *, low: float = 0.0, tone: float = 1.0) -> None:
        """Add a flat piece of any outline (k, 2)."""
        corners = np.asarray(outline, dtype=np.float32)
        levels = resample([(low, 0), (low + height, 0)])[:, 0]
        polygons = np.empty((len(levels), len(corners), 3), dtype=np.float32)
        polygons[..., :2] = corners
        polygons[..., 2] = levels[:, None]
        self.slices(polygons, part, tone, convex=False)

    def pieces(
        self,
        centers: ArrayLike,
        outline: FloatArray,
        thickness: float,
        part: int,
        tones: ArrayLike,
        angles: ArrayLike,
        tilt: float = 0.0,
    ) -> None:
        """Add many small pieces of one outline (k, 2), each a darker edge below a lighter top.

        Args:
            centers: (n, 3) undersides of the pieces, in the order of painting.
            outline: shape of a piece around the origin.
            thickness: thickness of a piece.
            part: the material.
            tones: (n,) brightness.
            angles: (n,) rotations.
            tilt: rise of a piece over its length along its own x axis.
        """
        middles = np.asarray(centers, dtype=np.float32)
        n, k = len(middles), len(outline)
        c, s = np.cos(angles)[:, None], np.sin(angles)[:, None]
        tops = np.empty((n, 2, k, 3), dtype=np.float32)
        tops[..., 0] = (middles[:, :1] + c * outline[:, 0] - s * outline[:, 1])[:, None]
        tops[..., 1] = (middles[:, 1:2] + s * outline[:, 0] + c * outline[:, 1])[:, None]
        tops[..., 2] = middles[:, 2, None, None] + tilt * outline[:, 0]
        tops[:, 1, :, 2] += thickness
        shades = np.asarray(tones, dtype=np.float32)[:, None] * np.array([0.72, 1.0], dtype=np.float32)
        self.slices(tops.reshape(2 * n, k, 3), part, shades.ravel())
