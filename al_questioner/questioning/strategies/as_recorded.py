"""Strategy that repeats recorded choices, of an earlier version that would decide otherwise today."""

from __future__ import annotations

import dataclasses

import numpy as np

from al_questioner.concepts import Selector
from al_questioner.domain import Action
from al_questioner.questioning.strategies.choice import Choice, Strategy, index_of
from al_questioner.questioning.turn_context import TurnContext


class AsRecorded:
    """Strategy that chooses what was recorded, and what another strategy chooses where nothing was.

    The other strategy decides in any case, so that it draws the same random numbers whatever was recorded.

    Attributes:
        recorded: the choice of the next turn; None to let the strategy choose.
    """

    def __init__(self, strategy: Strategy) -> None:
        self._strategy = strategy
        self.recorded: Action | None = None

    @property
    def selector(self) -> Selector | None:
        """Selector of the strategy."""
        return self._strategy.selector

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the recorded choice, with what the strategy says of all candidates.

        Raises:
            InputError: the recorded choice is not a candidate of this turn.
        """
        choice = self._strategy.choose(context, rng)
        if self.recorded is None:
            return choice
        return dataclasses.replace(choice, index=index_of(self.recorded, context))
