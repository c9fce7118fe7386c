"""Solids as stacks of slices, against slower ways to make them."""

from __future__ import annotations

import numpy as np

from al_questioner.simulation.kitchen.drawing.geometry import Solid, resample


def test_resampled_points_lie_on_the_polyline_close_together() -> None:
    """Otherwise a solid would have gaps between its slices."""
    corners = np.array([[0, 0], [0.03, 0.04], [0.03, 0.1]])
    points = resample(corners, 0.004)
    np.testing.assert_allclose(points[[0, -1]], corners[[0, -1]], atol=1e-7)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    assert steps.max() <= 0.004 + 1e-7
    assert len(points) == np.ceil(0.11 / 0.004) + 1
    upper = points[points[:, 1] > 0.04]
    np.testing.assert_allclose(upper[:, 0], 0.03, atol=1e-7)


def test_nothing_to_resample_keeps_both_ends() -> None:
    """Otherwise a flat lid, of no height, would vanish."""
    np.testing.assert_array_equal(resample([(1, 2), (1, 2)]), [[1, 2], [1, 2]])


def test_tube_ends_where_it_is_too_thin_for_the_level() -> None:
    """Otherwise a banana would have ends as blunt as its middle is thick."""
    path = np.stack([np.linspace(-0.05, 0.05, 11), np.zeros(11)], axis=1)
    radii = 0.02 * np.sqrt(1 - np.linspace(-0.95, 0.95, 11) ** 2)
    solid = Solid()
    solid.tube(path, radii, 1)
    for polygon in solid.stacks[0].polygons:
        level = polygon[0, 2] - radii.max()
        reached = np.flatnonzero(radii >= abs(level))
        ends = path[[reached[0], reached[-1]], 0]
        left, right = polygon[:11], polygon[11:][::-1]
        np.testing.assert_allclose(left[:, 0], np.clip(path[:, 0], *ends), atol=1e-7)
        np.testing.assert_allclose(right[:, 0], left[:, 0], atol=1e-7)
        np.testing.assert_allclose(left[reached, 1], np.sqrt(radii[reached] ** 2 - level**2), atol=1e-5)
        np.testing.assert_allclose(left[:, 1], -right[:, 1], atol=1e-7)
