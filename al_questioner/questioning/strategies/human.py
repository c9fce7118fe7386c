"""Strategy in which a person chooses the questions, so that imitation can learn from them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from al_questioner.domain import Action
from al_questioner.questioning.strategies.choice import Choice, index_of
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.turn_context import TurnContext

Picker = Callable[[TurnContext], int]
"""Function that returns the index of the chosen candidate."""


class Human:
    """Strategy in which a person chooses, among the same candidates as any strategy.

    The choice carries the expected decision features of all candidates, so it is a demonstration to learn from. The
    utility is 1 for the chosen candidate and 0 for all others.

    Args:
        pick: function that asks the person.

    Attributes:
        recorded: the choice of the next turn, if it was recorded, so that nobody is asked twice; None to ask.
    """

    selector = None

    def __init__(self, pick: Picker) -> None:
        self._pick = pick
        self.recorded: Action | None = None

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the choice of the person.

        Raises:
            EpisodeError: nobody is there to choose.
            InputError: the recorded choice is not a candidate of this turn.
        """
        # Computed before the question, so that the person does not wait after the answer.
        features = expected_features(context)
        index = self._pick(context) if self.recorded is None else index_of(self.recorded, context)
        utilities = np.zeros(len(context.candidates))
        utilities[index] = 1.0
        return Choice(index, utilities, features)
