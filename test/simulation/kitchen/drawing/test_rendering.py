"""Views: colour, depth and mask agree with one another, with the camera and with the thing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from al_questioner.domain import View, random_stream
from al_questioner.simulation.kitchen.drawing.geometry import Solid
from al_questioner.simulation.kitchen.drawing.projection import Pose
from al_questioner.simulation.kitchen.drawing.rendering import Lighting, draw_lighting, draw_pose, render
from al_questioner.simulation.kitchen.drawing.texture import Material
from al_questioner.simulation.kitchen.things.catalogue import CATALOGUES
from al_questioner.simulation.kitchen.things.kinds import Kind
from al_questioner.simulation.kitchen.things.vessels import Look
from al_questioner.simulation.task import AppearanceParameters, CameraParameters

PERFECT = CameraParameters(
    color_noise=0, blur_px=0, depth_noise_m=0, disparity_step=0, edge_holes=0, random_holes=0, shiny_holes=0
)
LIGHT = Lighting(np.array([-0.5, -0.5, 0.7071], dtype=np.float32), np.ones(3, dtype=np.float32), 0)
KINDS = [kind for catalogue in ('prepare_lunch', 'kitchen_table') for kind in CATALOGUES[catalogue]]


def cylinder(radius: float, height: float) -> Solid:
    solid = Solid()
    solid.lathe([(0, radius), (height, radius)], solid.material(Material((0.8, 0.2, 0.2))))
    return solid


def rendered(solid: Solid, pose: Pose, light: Lighting = LIGHT, **camera: float) -> View:
    """A view by a camera that is perfect but for these members."""
    return render(solid, pose, light, replace(PERFECT, **camera), random_stream(0, 'test'))


def points(view: View) -> NDArray[np.float64]:
    """(h, w, 3) metres in the camera's frame, by the pinhole model alone."""
    rows, columns = np.indices(view.mask.shape)
    z = view.depth / 1000
    x = (columns + view.origin[0] - view.camera.cx) * z / view.camera.fx
    y = (rows + view.origin[1] - view.camera.cy) * z / view.camera.fy
    return np.stack([x, y, z], axis=2)


@pytest.mark.parametrize('offset', [(0.0, 0.0), (-90.0, 60.0)])
@pytest.mark.parametrize('elevation', [40, 58])
@pytest.mark.parametrize(('radius', 'height'), [(0.04, 0.12), (0.08, 0.05)])
def test_size_in_metres_follows_from_mask_depth_and_intrinsics(
    radius: float, height: float, elevation: float, offset: tuple[float, float]
) -> None:
    """Perception measures in metres: table plane by least squares, then the height above it and the width across it.

    Tolerances: a pixel at each end, and a millimetre for the rounding of the depth.
    """
    pose = Pose(1.0, 0.3, 1.0, np.deg2rad(elevation), offset)
    view = rendered(cylinder(radius, height), pose)
    cloud, table = points(view), (view.depth > 0) & ~view.mask
    center = cloud[table].mean(axis=0)
    _, _, axes = np.linalg.svd(cloud[table] - center, full_matrices=False)
    heights = (cloud - center) @ axes[2]
    assert np.abs(heights[table]).max() < 0.002
    thing = np.abs(heights[view.mask])
    pixel = 1 / view.camera.fx
    assert thing.max() == pytest.approx(height, abs=2 * pixel + 0.001)
    top = view.mask & (np.abs(heights) > height - 0.004)
    across = cloud[top][:, 0]
    assert np.ptp(across) == pytest.approx(2 * radius, abs=3 * pixel)


def test_size_factor_scales_the_thing() -> None:
    poses = (Pose(size, 0, 1.0, 0.8, (0, 0)) for size in (1.0, 2.0))
    single, double = (rendered(cylinder(0.03, 0.06), pose).mask.sum() for pose in poses)
    assert double / single == pytest.approx(4, rel=0.08)


@pytest.mark.parametrize('kind', KINDS, ids=lambda kind: kind.name)
def test_every_kind_can_be_seen_in_each_state(kind: Kind) -> None:
    """No mask is empty or cut off and no thing lacks depth, which would stop perception in an episode."""
    camera = CameraParameters()
    rng = random_stream(1, f'test/{kind.name}')
    for state in kind.states:
        look = Look(float(rng.uniform(0.85, 1.15)), float(rng.normal(0, 8)), 1.0, float(rng.random()))
        solid = state.draw(look, rng)
        pose = draw_pose(rng, solid, look.size, camera)
        view = render(solid, pose, draw_lighting(rng, AppearanceParameters()), camera, rng)
        assert view.color.shape == (*view.mask.shape, 3)
        assert view.depth.shape == view.mask.shape
        assert [array.dtype.name for array in (view.color, view.depth, view.mask)] == ['uint8', 'uint16', 'bool']
        assert view.mask.sum() > 40
        rim = np.concatenate([view.mask[0], view.mask[-1], view.mask[:, 0], view.mask[:, -1]])
        assert not rim.any()
        assert 0 <= view.origin[0] <= 640 - view.mask.shape[1]
        assert 0 <= view.origin[1] <= 480 - view.mask.shape[0]
        assert (view.depth[view.mask] > 0).mean() > 0.3
        assert 30 <= max(view.mask.shape) <= 260


def test_the_depth_camera_misses_what_a_kinect_misses() -> None:
    """Outline, shadow of the projector to the left, glass, and specks here and there; each can be turned off."""
    solid = cylinder(0.05, 0.1)
    pose = Pose(1.0, 0, 1.0, 0.8, (0, 0))
    perfect = rendered(solid, pose)
    shadow, mask = perfect.depth == 0, perfect.mask
    edge, random = (rendered(solid, pose, **{name: 0.5}).depth == 0 for name in ('edge_holes', 'random_holes'))
    assert not (shadow & mask).any()
    columns = np.flatnonzero(shadow.any(axis=0))
    assert len(columns) > 0
    assert columns.mean() < np.flatnonzero(mask.any(axis=0)).mean()
    assert 0.4 < random[mask].mean() < 0.6
    assert (edge & mask).any()

    glass = Solid()
    glass.lathe([(0, 0.05), (0.1, 0.05)], glass.material(Material((1, 1, 1), clear=0.8)))
    seen = rendered(glass, pose, shiny_holes=0.5)
    assert 0.25 < (seen.depth[seen.mask] == 0).mean() < 0.75


def test_depth_noise_and_steps_grow_with_the_square_of_the_distance() -> None:
    """Khoshelham and Elberink (2012); the oracle is the spread around the noiseless image."""
    solid = cylinder(0.08, 0.05)
    for distance in (1.0, 2.0):
        pose = Pose(1.0, 0, distance, 0.8, (0, 0))
        exact = rendered(solid, pose).depth.astype(float)
        noisy = rendered(solid, pose, depth_noise_m=0.004).depth.astype(float)
        both = (exact > 0) & (noisy > 0)
        expected = 4 * (exact[both] / 1000) ** 2
        assert np.std((noisy - exact)[both] / expected) == pytest.approx(1, abs=0.08)
        stepped = rendered(solid, pose, disparity_step=0.125).depth
        levels = np.unique(stepped[stepped > 0])
        step = 0.125 * distance**2 / (525 * 0.075) * 1000
        assert np.median(np.diff(levels)) == pytest.approx(step, abs=1)


def test_light_from_the_left_brightens_the_left() -> None:
    """Otherwise things would look flat, like in a cartoon."""
    ball = Solid()
    ball.ball(0.05, 0.1, ball.material(Material((0.7, 0.7, 0.7), shine=0, grain=0)))
    left = replace(LIGHT, toward=np.array([-0.8, 0, 0.6], dtype=np.float32))
    view = rendered(ball, Pose(1.0, 0, 1.0, 0.8, (0, 0)), left)
    columns = np.flatnonzero(view.mask.any(axis=0))
    half = int(columns.mean())
    grey = view.color.mean(axis=2)
    assert grey[:, :half][view.mask[:, :half]].mean() > 1.2 * grey[:, half:][view.mask[:, half:]].mean()
