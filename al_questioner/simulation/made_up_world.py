"""World with invented features, to try a task before the robot is there."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import NO_SYMBOL, Camera, Observation, Scene, View, group_of, random_stream
from al_questioner.simulation.kitchen.drawing.geometry import Solid
from al_questioner.simulation.kitchen.pool import ViewSpec, position_of
from al_questioner.simulation.kitchen.things.kinds import Kind, State
from al_questioner.simulation.simulated_world import SimulatedWorld
from al_questioner.simulation.task import Task

GROUPS = ('colour', 'size')
"""Feature groups that matter in a task that does not name any."""
IRRELEVANT_GROUPS = ('noise', 'other', 'further')
"""Names for the feature group that does not matter; the first one that the task does not use is taken."""
FEATURES_PER_GROUP = 2
KINDS_PER_SYMBOL, KINDS_OF_CLUTTER, STATES = 2, 12, 3
KIND_SPREAD, STATE_SPREAD, VIEW_SPREAD = 0.4, 0.4, 0.15
"""Standard deviations between kinds, their states and two looks at one, in standard deviations of the symbols."""
UNSEEN = View(
    np.zeros((1, 1, 3), np.uint8),
    np.zeros((1, 1), np.uint16),
    np.ones((1, 1), bool),
    Camera(1.0, 1.0, 0.0, 0.0),
    (0, 0),
)
"""Empty view of an invented object."""


class MadeUpWorld(SimulatedWorld):
    """A simulated table whose objects are numbers: the task's groups distinguish its symbols, another one does not.

    Attributes:
        relevant_groups: those of the task, or else `GROUPS`.
    """

    def __init__(self, task: Task, seed: int, sample: int) -> None:
        self.relevant_groups = tuple(dict.fromkeys(map(group_of, task.relevant_groups))) or GROUPS
        self._irrelevant_group = next(each for each in IRRELEVANT_GROUPS if each not in self.relevant_groups)
        scenes = dataclasses.replace(task.scenes, training_size=max(task.scenes.training_size, task.scenes.objects))
        super().__init__(dataclasses.replace(task, scenes=scenes), seed, sample, _kinds(task))

    def report(self) -> str:
        """Return a text about the invented features."""
        matter = 'matters' if len(self.relevant_groups) == 1 else 'matter'
        groups = ', '.join(self.relevant_groups)
        return f'dry run on made-up features: {groups} {matter}, {self._irrelevant_group} does not'

    def _observe(self, view_spec: ViewSpec, object_id: int) -> Observation:
        rng = random_stream(self._sample_number, f'made up/observation/{view_spec.key}')
        relevant = len(self.relevant_groups) * FEATURES_PER_GROUP
        kind = view_spec.thing.kind
        centre = self._drawn(f'symbol/{kind.symbol if kind.symbol != NO_SYMBOL else kind.name}', relevant)
        centre = centre + KIND_SPREAD * self._drawn(f'kind/{kind.name}', relevant)
        centre = centre + STATE_SPREAD * self._drawn(f'state/{kind.name}/{view_spec.state}', relevant)
        values = [*(centre + rng.normal(0, VIEW_SPREAD, relevant)), *rng.normal(0, 1, FEATURES_PER_GROUP)]
        groups = (*self.relevant_groups, self._irrelevant_group)
        names = [f'{group}_{number}' for group in groups for number in range(1, FEATURES_PER_GROUP + 1)]
        position = position_of(view_spec, self._task, rng)
        return Observation(object_id, position, UNSEEN, dict(zip(names, map(float, values), strict=True)))

    def _drawn(self, what: str, count: int) -> NDArray[np.float64]:
        """Return the constant part of something's features, the same at every look."""
        return random_stream(self._sample_number, f'made up/{what}').normal(0, 1, count)


def made_up_scene(observations: Sequence[Observation]) -> Scene:
    """Return the scene of observations of a `MadeUpWorld`: their features are sensor readings only."""
    return Scene(
        tuple(observation.object_id for observation in observations),
        np.array([observation.position for observation in observations], dtype=np.float32),
        np.array([list(observation.sensors.values()) for observation in observations], dtype=np.float32),
        tuple(observations[0].sensors),
    )


def _kinds(task: Task) -> dict[str, tuple[Kind, ...]]:
    """Return the kinds of objects of each symbol, and of clutter."""
    counts = dict.fromkeys(task.symbols, task.appearance.kinds_per_symbol or KINDS_PER_SYMBOL)
    counts[NO_SYMBOL] = task.appearance.kinds_of_clutter or KINDS_OF_CLUTTER
    states = tuple(State(f'state {i}', _never, 0.0) for i in range(STATES if task.scenes.turnover == 'state' else 1))
    return {
        symbol: tuple(Kind(f'{symbol} {number}', symbol, states) for number in range(1, count + 1))
        for symbol, count in counts.items()
    }


def _never(look: object, rng: object) -> Solid:
    raise RuntimeError('a made-up object has no shape')
