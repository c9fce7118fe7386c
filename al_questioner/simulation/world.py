"""Protocols of a world: scenes that change over time, and held-out test observations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Observation, Scene


@dataclass(frozen=True, eq=False)
class Table:
    """A table that no learner has seen.

    Attributes:
        observations: one per object.
        symbols: symbol, or 'none', by object id.
    """

    observations: tuple[Observation, ...]
    symbols: Mapping[int, str]


class World(Protocol):
    """Interface of a world, simulated or recorded, for the perception node, the scripted teacher and the evaluation."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """Concepts to ground."""
        ...

    def scene(self, turn: int) -> tuple[Observation, ...]:
        """Return the observations of the table in a turn (1-based), one per object.

        Turns can be asked for in any order. While the scene is unchanged, they return identical objects.

        Raises:
            InputError: a turn below 1.
        """
        ...

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return symbol, or 'none', by object id: for the scripted teacher only. Nothing is rendered.

        Raises:
            InputError: a turn below 1.
        """
        ...

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns up to `turns` that begin with a scene change; the first turn is not one."""
        ...

    def training_pool(self, rows: Sequence[int] | None = None) -> tuple[Observation, ...]:
        """Return the observations that scenes are drawn from, all or those of these rows: for calibration only."""
        ...

    def training_labels(self) -> tuple[str, ...]:
        """Return symbol, or 'none', of each observation of the training pool."""
        ...

    def test_observations(self) -> tuple[Observation, ...]:
        """Return held-out observations, disjoint from the training pool."""
        ...

    def test_labels(self) -> tuple[str, ...]:
        """Return the symbol of each test observation, never 'none'."""
        ...

    def validation_observations(self) -> tuple[Observation, ...]:
        """Return a second draw of held-out observations: for code that may know the truth, never for results.

        Raises:
            InputError: this world has no second draw.
        """
        ...

    def validation_labels(self) -> tuple[str, ...]:
        """Return the symbol of each validation observation.

        Raises:
            InputError: this world has no second draw.
        """
        ...

    def new_table(self, number: int = 0) -> Table:
        """Return a table like those of the scenes, clutter included, of held-out observations.

        Tables of other numbers are drawn independently; their things may be the same ones in a world of few things.

        Raises:
            InputError: a number below 0.
        """
        ...

    def report(self) -> str:
        """Return a text for the user about the source of the observations; empty if there is nothing to say."""
        ...


class SeenWorld(Protocol):
    """Interface of a world as feature vectors, for an episode in one process, its scripted teacher and evaluation."""

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn (1-based); the same object as long as nothing changes."""
        ...

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return symbol, or 'none', by object id: for the scripted teacher only."""
        ...

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns up to `turns` that begin with a scene change; the first turn is not one."""
        ...

    @property
    def test_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Features of the held-out observations, (k, m), and their k symbols."""
        ...

    @property
    def validation_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """Features of a second draw of held-out observations, and their symbols: for the greedy oracle.

        Raises:
            InputError: the world has no second draw.
        """
        ...

    def report(self) -> str:
        """Return a text for the user about the source of the observations; empty if there is nothing to say."""
        ...
