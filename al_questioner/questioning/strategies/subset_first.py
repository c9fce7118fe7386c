"""Common base of the control strategies, which makes the comparison with them fair.

All of them ask for the relevant features once, in the first turn if the budget can pay for a first example as well,
and never ask about a view that has been labelled.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Action, QueryKind
from al_questioner.questioning.candidates import is_affordable
from al_questioner.questioning.strategies.choice import (
    Choice,
    choose_best,
    nothing_considered,
    rows_of,
    settled_actions,
)
from al_questioner.questioning.turn_context import TurnContext


class SubsetFirst(ABC):
    """Strategy of one early feature subset query, then queries of one kind."""

    selector = None
    kind = QueryKind.LABEL

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the feature subset query when it is due, otherwise the query of largest value."""
        utilities = nothing_considered(context)
        if self._subset_is_due(context):
            utilities[rows_of(context, QueryKind.FEATURE_SUBSET)] = 1.0
        else:
            rows = rows_of(context, self.kind)
            # Values may take long to find, and are not needed once the budget is gone.
            if len(rows):
                utilities[rows] = self.values(context)
        return choose_best(context, utilities, rng)

    @abstractmethod
    def values(self, context: TurnContext) -> NDArray[np.float64]:
        """Return the value of each query of the strategy's kind, in canonical order; NaN for a forbidden one."""

    def _subset_is_due(self, context: TurnContext) -> bool:
        both = context.costs.feature_subset + context.costs.price(self.kind)
        subset = Action(QueryKind.FEATURE_SUBSET)
        is_left = subset in context.candidates and subset not in settled_actions(context)
        return is_left and is_affordable(both, context.budget_left)


class UnlabelledFirst(SubsetFirst):
    """Strategy of label queries about views without a label."""

    def values(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) the strategy's score, NaN for labelled views."""
        return np.where(context.labelled, np.nan, self.score(context))

    @abstractmethod
    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) value of labelling each object."""
