"""Conversion of the observations of a turn to the scene that the learner sees."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import InputError, Observation, Scene, SceneError, View
from al_questioner.perception.features import VIEW_FEATURE_NAMES, view_features

Measure = Callable[[View], NDArray[np.float32]]
"""Function that maps a view to the entries of `VIEW_FEATURE_NAMES`."""


def perceive(observations: Sequence[Observation], measure: Measure = view_features) -> Scene:
    """Return the scene of n observations: (n, m) features, `VIEW_FEATURE_NAMES` and then the sensor readings.

    The readings are in the order of the first observation. Views that return may be measured with a cache.

    Raises:
        SceneError: no observation, or a reading that is not finite.
        InputError: a view that cannot be measured, or sensors that differ between objects; names the object.
    """
    if not observations:
        raise SceneError('the scene is empty: it holds no object')
    sensor_names = tuple(observations[0].sensors)
    rows = [_features(observation, sensor_names, measure) for observation in observations]
    return Scene(
        object_ids=tuple(observation.object_id for observation in observations),
        positions=np.array([observation.position for observation in observations], dtype=np.float32),
        features=np.stack(rows),
        feature_names=VIEW_FEATURE_NAMES + sensor_names,
    )


def _features(observation: Observation, sensor_names: tuple[str, ...], measure: Measure) -> NDArray[np.float32]:
    sensors = observation.sensors
    if different := sorted(set(sensors) ^ set(sensor_names)):
        raise InputError(
            f'object {observation.object_id}: every object needs the same sensors, but {", ".join(different)}'
            ' is not known of all of them'
        )
    try:
        visual = measure(observation.view)
    except InputError as error:
        raise InputError(f'object {observation.object_id}: {error}') from error
    readings = np.array([sensors[name] for name in sensor_names], dtype=np.float32)
    return np.concatenate([visual, readings])
