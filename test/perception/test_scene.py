"""From observations to the scene the learner sees: order, names, and what is refused."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from al_questioner.domain import Camera, InputError, Observation, SceneError, View
from al_questioner.perception import VIEW_FEATURE_NAMES, perceive, view_features

SENSORS = {'weight_kg': 0.25, 'base_x': -1.0}


def observation(object_id: int, sensors: Mapping[str, float] = SENSORS, empty: bool = False) -> Observation:
    color = np.random.default_rng(object_id).integers(0, 256, (30, 40, 3), dtype=np.uint8)
    mask = np.zeros((30, 40), dtype=bool)
    mask[5:25, 5:35] = not empty
    view = View(color, np.full((30, 40), 700, np.uint16), mask, Camera(525.0, 525.0, 319.5, 239.5), (0, 0))
    return Observation(object_id, (0.1 * object_id, 0.2, 0.0), view, sensors)


def test_scene_holds_view_features_then_readings_in_float32() -> None:
    observations = [observation(4), observation(2, {'weight_kg': 0.5, 'base_x': 3.0})]
    scene = perceive(observations)
    assert scene.object_ids == (4, 2)
    assert scene.feature_names == (*VIEW_FEATURE_NAMES, 'weight_kg', 'base_x')
    assert scene.features.dtype == scene.positions.dtype == np.float32
    for row, seen in zip(scene.features, observations, strict=True):
        assert np.array_equal(row[: len(VIEW_FEATURE_NAMES)], view_features(seen.view))
        assert row[len(VIEW_FEATURE_NAMES) :].tolist() == list(seen.sensors.values())
    assert np.allclose(scene.positions, [[0.4, 0.2, 0], [0.2, 0.2, 0]])


def test_readings_are_matched_by_name_not_by_order() -> None:
    scene = perceive([observation(1), observation(2, {'base_x': 7.0, 'weight_kg': 0.5})])
    assert scene.features[1, -2:].tolist() == [0.5, 7.0]


def test_views_are_measured_as_the_caller_wishes() -> None:
    """Otherwise a view that comes back could not be remembered."""
    remembered = view_features(observation(9).view)
    scene = perceive([observation(1), observation(2)], lambda view: remembered)
    np.testing.assert_array_equal(scene.features[:, : len(remembered)], [remembered, remembered])


def test_view_alone_is_enough() -> None:
    assert perceive([observation(1, {})]).feature_names == VIEW_FEATURE_NAMES


def test_no_observation_is_refused() -> None:
    with pytest.raises(SceneError, match='the scene is empty'):
        perceive([])


@pytest.mark.parametrize('other', [{'weight_kg': 0.5}, {**SENSORS, 'noise_max': 1.0}])
def test_different_sensors_are_refused(other: Mapping[str, float]) -> None:
    with pytest.raises(InputError, match='object 2: every object needs the same sensors'):
        perceive([observation(1), observation(2, other)])


def test_object_with_an_empty_mask_is_named() -> None:
    with pytest.raises(InputError, match='object 5: the mask is empty'):
        perceive([observation(1), observation(5, empty=True)])


def test_reading_that_is_not_finite_is_refused() -> None:
    with pytest.raises(SceneError, match='feature base_x of object 2 is not finite'):
        perceive([observation(1), observation(2, {'weight_kg': 0.5, 'base_x': float('nan')})])
