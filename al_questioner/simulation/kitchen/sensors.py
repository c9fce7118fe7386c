"""Simulated readings of the robot's other sensors, as in the footnote of the paper's section 4.1.

They are the object's position relative to the interest points of the kitchen and to the robot, the position of the
robot's base, the joints of both arms, pose and opening of both hands, the volume of noise, and the object's weight.
Gaussian noise is added to every reading. Only the weight depends on the object's kind; so does its place, if objects
are kept cold.
"""

from __future__ import annotations

from types import MappingProxyType

import numpy as np

from al_questioner.simulation.task import SensorParameters

INTEREST_POINTS = MappingProxyType(
    {'countertop': (0.0, 0.0), 'stove': (-1.1, 0.6), 'refrigerator': (2.3, 0.5), 'pantry': (1.2, 2.6)}
)
"""Position (x, y) of each interest point, metres in the table's frame; its origin is a corner of the counter top."""

REFRIGERATOR = INTEREST_POINTS['refrigerator']

_JOINTS = 7
_REACH_M = (0.45, 0.75)
_LOUDNESS_DB = 45.0


def read_sensors(
    rng: np.random.Generator, position: tuple[float, float, float], weight_kg: float, noise: SensorParameters
) -> dict[str, float]:
    """Return readings of all sensors except the camera, taken while the robot looks at one object.

    The robot stands somewhere in front of the object, its arms and hands in random positions.

    Args:
        rng: the robot's pose, and the noise.
        position: (x, y, z) metres of the object in the table's frame.
        weight_kg: true weight of the object.
        noise: standard deviations.

    Returns:
        48 readings by name, each name prefixed with its group: location, base, arms, hands, noise, weight.
    """
    place = np.array(position)
    heading = np.pi / 2 + rng.normal(0, 0.25)
    base = place[:2] - rng.uniform(*_REACH_M) * np.array([np.cos(heading), np.sin(heading)])
    readings: dict[str, float] = {}

    for name, point in INTEREST_POINTS.items():
        offset = place[:2] - np.array(point) + rng.normal(0, noise.location_m, 2)
        readings[f'location_{name}_x'], readings[f'location_{name}_y'] = offset
    ahead = place[:2] - base
    across = np.array([np.sin(heading), -np.cos(heading)])
    forward, right = ahead @ np.array([np.cos(heading), np.sin(heading)]), ahead @ across
    relative = np.array([forward, -right, place[2]]) + rng.normal(0, noise.location_m, 3)
    readings.update(zip(('location_base_x', 'location_base_y', 'location_base_z'), relative, strict=True))

    stove = np.array(INTEREST_POINTS['stove'])
    absolute, counter = base - stove + rng.normal(0, noise.base_m, 2), base + rng.normal(0, noise.base_m, 2)
    readings['base_x'], readings['base_y'] = absolute
    readings['base_heading'] = heading + rng.normal(0, noise.base_rad)
    readings['base_countertop_x'], readings['base_countertop_y'] = counter

    for side, sign in (('left', 1.0), ('right', -1.0)):
        joints = rng.uniform(-1.4, 1.4, _JOINTS) + rng.normal(0, noise.arms_rad, _JOINTS)
        readings.update({f'arms_{side}_{i + 1}': angle for i, angle in enumerate(joints)})
        hand = np.array([rng.uniform(0.25, 0.65), sign * rng.uniform(0.1, 0.45), rng.uniform(0.7, 1.2)])
        hand += rng.normal(0, noise.hands_m, 3)
        readings.update({f'hands_{side}_{axis}': value for axis, value in zip('xyz', hand, strict=True)})
        turn = rng.uniform(-1.2, 1.2, 3) + rng.normal(0, noise.arms_rad, 3)
        readings.update(
            {f'hands_{side}_{axis}': angle for axis, angle in zip(('roll', 'pitch', 'yaw'), turn, strict=True)}
        )
        readings[f'hands_{side}_open'] = float(rng.random() < 0.5) + rng.normal(0, noise.hands_m)

    mean = _LOUDNESS_DB + rng.normal(0, noise.noise_db)
    readings['noise_mean'] = mean
    readings['noise_min'] = mean - 8 - abs(rng.normal(0, noise.noise_db))
    readings['noise_max'] = mean + 12 + abs(rng.normal(0, noise.noise_db))
    readings['weight_kg'] = weight_kg + rng.normal(0, noise.weight_kg)
    return {name: float(value) for name, value in readings.items()}
