"""From points on the table to pixels of a crop."""

from __future__ import annotations

import numpy as np

from al_questioner.domain import Camera
from al_questioner.simulation.kitchen.drawing.geometry import Solid
from al_questioner.simulation.kitchen.drawing.projection import FINE, SHIFT, Pose, Projection
from al_questioner.simulation.kitchen.drawing.texture import Material

CAMERA = Camera(525.0, 525.0, 319.5, 239.5)
POSE = Pose(size=1.1, heading=0.4, distance=1.0, elevation=0.8, offset_px=(30.0, -20.0))
MARGIN = 6


def mug() -> Solid:
    solid = Solid()
    part = solid.material(Material((0.5, 0.5, 0.5)))
    solid.lathe([(0, 0.04), (0.09, 0.04)], part)
    solid.strand([(0.04, 0, 0.02), (0.07, 0, 0.05), (0.04, 0, 0.08)], 0.005, part)
    return solid


def test_crop_shows_the_solid_with_its_margin() -> None:
    """Otherwise a thing would be cut off, and measured too small."""
    projection, _, polygons = Projection.around(mug(), POSE, CAMERA, MARGIN)
    # On the fine grid a crop's pixel is two, its middle a quarter further on.
    pixels = np.concatenate([some.reshape(-1, 2) for some in polygons]) / (FINE << SHIFT) - 0.25
    low, high = pixels.min(axis=0), np.array(projection.shape[::-1]) - 1 - pixels.max(axis=0)
    for margin in (*low, *high):
        assert MARGIN - 0.05 <= margin <= MARGIN + 1.05


def test_polygons_lie_where_their_points_do() -> None:
    """Otherwise a thing would be painted beside its shadow and its depth."""
    solid = mug()
    projection, placed, polygons = Projection.around(solid, POSE, CAMERA, MARGIN)
    for stack, points, pixels in zip(solid.stacks, placed, polygons, strict=True):
        np.testing.assert_allclose(points, projection.place(stack.polygons), atol=1e-6)
        np.testing.assert_array_equal(pixels, projection.pixels(points))


def test_bare_table_is_equally_deep_along_a_row() -> None:
    """Its depth is found once a row."""
    projection, _, _ = Projection.around(mug(), POSE, CAMERA, MARGIN)
    rows, _ = projection.shape
    whole = projection.unproject(np.zeros(projection.shape, dtype=np.float32))[2]
    once = projection.unproject(np.zeros((rows, 1), dtype=np.float32))[2]
    np.testing.assert_array_equal(np.broadcast_to(once, projection.shape), whole)
