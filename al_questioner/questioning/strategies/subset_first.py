"""What the controls share without which no comparison is honest.

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
    """One early feature subset query, then queries of one kind.

    Attributes:
        kind: of the queries after the first.
    """

    selector = None
    kind = QueryKind.LABEL

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """The feature subset query when it is due, else what the control is about."""
        utilities = nothing_considered(context)
        if self._subset_is_due(context):
            utilities[rows_of(context, QueryKind.FEATURE_SUBSET)] = 1.0
        else:
            rows = rows_of(context, self.kind)
            utilities[rows] = self.values(context)[: len(rows)]
        return choose_best(context, utilities, rng)

    @abstractmethod
    def values(self, context: TurnContext) -> NDArray[np.float64]:
        """Value of each query of the control's kind, in canonical order; NaN for one that is not to be asked."""

    def _subset_is_due(self, context: TurnContext) -> bool:
        both = context.costs.feature_subset + context.costs.price(self.kind)
        subset = Action(QueryKind.FEATURE_SUBSET)
        is_left = subset in context.candidates and subset not in settled_actions(context)
        return is_left and is_affordable(both, context.budget_left)


class UnlabelledFirst(SubsetFirst):
    """Label queries about views that nothing is known of."""

    def values(self, context: TurnContext) -> NDArray[np.float64]:
        """(|X|,) the control's score, NaN for what was labelled."""
        return np.where(context.labelled, np.nan, self.score(context))

    @abstractmethod
    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """(|X|,) value of labelling each object."""
