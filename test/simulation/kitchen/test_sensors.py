"""The robot's other sensors."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from al_questioner.domain import group_of, random_stream
from al_questioner.simulation.kitchen.sensors import INTEREST_POINTS, read_sensors
from al_questioner.simulation.task import SensorParameters

QUIET = SensorParameters(**{f.name: 0.0 for f in fields(SensorParameters)})
PLACE = (0.5, 0.3, 0.0)


def test_the_readings_of_the_papers_footnote_are_there() -> None:
    names = read_sensors(random_stream(1, 'test'), PLACE, 0.5, SensorParameters())
    assert {group_of(name) for name in names} == {'location', 'base', 'arms', 'hands', 'noise', 'weight'}
    assert len(names) == 48
    assert all(f'location_{point}_x' in names for point in ('countertop', 'stove', 'refrigerator', 'pantry', 'base'))
    assert {'hands_left_open', 'hands_right_open', 'arms_left_7', 'arms_right_1', 'weight_kg'} <= names.keys()
    assert names['noise_min'] < names['noise_mean'] < names['noise_max']


def test_without_noise_the_geometry_is_exact() -> None:
    """Location relative to the robot's base, turned by its heading and moved to the base, is the location."""
    r = read_sensors(random_stream(2, 'test'), PLACE, 0.5, QUIET)
    for name, point in INTEREST_POINTS.items():
        assert r[f'location_{name}_x'] == pytest.approx(PLACE[0] - point[0])
        assert r[f'location_{name}_y'] == pytest.approx(PLACE[1] - point[1])
    c, s = np.cos(r['base_heading']), np.sin(r['base_heading'])
    x, y = r['location_base_x'], r['location_base_y']
    assert r['base_countertop_x'] + c * x - s * y == pytest.approx(PLACE[0])
    assert r['base_countertop_y'] + s * x + c * y == pytest.approx(PLACE[1])
    assert r['weight_kg'] == 0.5


@pytest.mark.parametrize(
    ('name', 'truth'), [('weight_kg', 0.5), ('location_stove_x', PLACE[0] - INTEREST_POINTS['stove'][0])]
)
def test_noise_is_gaussian_with_the_given_deviation(name: str, truth: float) -> None:
    """Bounds of about five standard errors of mean and deviation."""
    rng = random_stream(3, 'test')
    noise = SensorParameters(weight_kg=0.05, location_m=0.05)
    errors = np.array([read_sensors(rng, PLACE, 0.5, noise)[name] for _ in range(2000)]) - truth
    assert abs(errors.mean()) < 5 * 0.05 / np.sqrt(2000)
    assert abs(errors.std() / 0.05 - 1) < 5 / np.sqrt(2 * 2000)


def test_only_the_weight_depends_on_the_weight() -> None:
    """No other sensor gives the class away, which would make the feature subset query worthless."""
    light = read_sensors(random_stream(4, 'test'), PLACE, 0.1, SensorParameters())
    heavy = read_sensors(random_stream(4, 'test'), PLACE, 2.0, SensorParameters())
    assert {name for name in light if light[name] != heavy[name]} == {'weight_kg'}
