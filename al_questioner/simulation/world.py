"""What a world is: scenes that change over time, and held-out test observations."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Protocol

from al_questioner.domain import Observation


class World(Protocol):
    """What the perception node, the scripted teacher and the evaluation need of a world, simulated or recorded."""

    @property
    def symbols(self) -> tuple[str, ...]:
        """The concepts to ground."""
        ...

    def scene(self, turn: int) -> tuple[Observation, ...]:
        """What is on the table in a turn (1-based): one observation per object.

        Turns can be asked for in any order. While the scene stays, they return identical objects.

        Raises:
            InputError: a turn below 1.
        """
        ...

    def truth(self, turn: int) -> Mapping[int, str]:
        """Symbol, or 'none', by object id: for the scripted teacher alone. Renders nothing.

        Raises:
            InputError: a turn below 1.
        """
        ...

    def change_turns(self, turns: int) -> list[int]:
        """The turns up to `turns` that begin with a scene change; the first turn is none."""
        ...

    def training_pool(self, rows: Sequence[int] | None = None) -> tuple[Observation, ...]:
        """The observations that scenes are drawn from, all or those of these rows: for calibration alone."""
        ...

    def training_labels(self) -> tuple[str, ...]:
        """Symbol, or 'none', of each observation of the training pool."""
        ...

    def test_observations(self) -> tuple[Observation, ...]:
        """Held-out observations, disjoint from the training pool."""
        ...

    def test_labels(self) -> tuple[str, ...]:
        """Symbol of each test observation, never 'none'."""
        ...

    def validation_observations(self) -> tuple[Observation, ...]:
        """A second draw of held-out observations: for whoever may know the truth, never for results.

        Raises:
            InputError: this world has no second draw.
        """
        ...

    def validation_labels(self) -> tuple[str, ...]:
        """Symbol of each validation observation.

        Raises:
            InputError: this world has no second draw.
        """
        ...

    def report(self) -> str:
        """What a user should know of where the observations come from; empty if there is nothing to say."""
        ...
