"""A strategy of one's own: label the object whose two most probable symbols are nearest to each other."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from al_questioner.domain import QueryKind
from al_questioner.questioning import Choice, TurnContext, choose_best, nothing_considered, rows_of, symbol_given_object


class SmallestMargin:
    """One early feature subset query, then labels for what is most nearly confused.

    Raises:
        ValueError: weights, for which it has no use.
    """

    selector = None

    def __init__(self, weights: Mapping[str, float]) -> None:
        if weights:
            raise ValueError('it uses no weights')

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """The relevant features, once; then the unlabelled object of the smallest margin."""
        utilities = nothing_considered(context)
        # More than minus any margin, and never again: `choose_best` leaves out what is settled.
        utilities[rows_of(context, QueryKind.FEATURE_SUBSET)] = 1.0
        second, first = np.sort(symbol_given_object(context.probabilities), axis=1)[:, -2:].T
        values = np.where(context.labelled, np.nan, second - first)
        # What the budget cannot pay for is no candidate, so there is a row for every object or for none.
        rows = rows_of(context, QueryKind.LABEL)
        utilities[rows] = values[: len(rows)]
        return choose_best(context, utilities, rng)
