"""World as the learner's perception shows it."""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Observation, Scene
from al_questioner.perception import perceive, view_features
from al_questioner.simulation.world import Table, World

See = Callable[[Sequence[Observation]], Scene]
"""Function that converts observations to feature vectors."""


class PerceivedWorld:
    """A world as feature vectors; an unchanged scene is perceived once, a view that returns is measured once.

    Args:
        world: the world to perceive.
        see: converts observations to a scene; without it, our perception does.
    """

    def __init__(self, world: World, see: See | None = None) -> None:
        self._world = world
        # Views are equal if they are the same object; a world keeps those it has shown anyway.
        self._see = see or partial(perceive, measure=lru_cache(maxsize=None)(view_features))
        self._seen: tuple[Observation, ...] = ()
        self._scene: Scene | None = None

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return symbol, or 'none', by object id: for the scripted teacher only."""
        return self._world.truth(turn)

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns up to `turns` that begin with a scene change."""
        return self._world.change_turns(turns)

    def report(self) -> str:
        """Return a text for the user about the source of the observations."""
        return self._world.report()

    def observations(self, turn: int) -> tuple[Observation, ...]:
        """Return the observations of the table in a turn."""
        return self._world.scene(turn)

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn; the same object as long as nothing changes."""
        observations = self._world.scene(turn)
        same = len(observations) == len(self._seen) and all(map(operator.is_, observations, self._seen))
        if self._scene is None or not same:
            self._seen, self._scene = observations, self._see(observations)
        return self._scene

    def new_table(self, number: int = 0) -> tuple[Scene, Table]:
        """Return a held-out table as a scene, and what is really on it, see `World.new_table`.

        Raises:
            InputError: a number below 0.
        """
        table = self._world.new_table(number)
        return self._see(table.observations), table

    @cached_property
    def test_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Features of the held-out observations, (k, m), and their k symbols."""
        return self._see(self._world.test_observations()).features, self._world.test_labels()

    @cached_property
    def validation_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Features of a second draw of held-out observations, (k, m), and their k symbols: for the greedy oracle.

        Raises:
            InputError: the world has no second draw.
        """
        return self._see(self._world.validation_observations()).features, self._world.validation_labels()
