"""Strategy `u_sampling`: the baseline of the paper."""

from __future__ import annotations

import numpy as np

from al_questioner.concepts import Selector, select_features
from al_questioner.domain import QueryKind
from al_questioner.questioning.strategies.choice import Choice, choose_best, nothing_considered, rows_of
from al_questioner.questioning.strategies.decision_features import prediction_entropy
from al_questioner.questioning.turn_context import TurnContext


class UncertaintySampling:
    """Strategy that labels the object of largest prediction entropy, every turn until the budget is gone.

    As in the paper it has no feature subset query, so features are selected computationally. The paper does not say
    how, and not whether a view may be asked about again.

    Args:
        selector: selector of the features; None for none.
        repeats: whether it may ask about a view that has been labelled.
    """

    def __init__(self, selector: Selector | None = select_features, repeats: bool = True) -> None:
        self.selector = selector
        self._repeats = repeats

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the affordable label query of largest entropy; no query if there is none."""
        utilities, rows = nothing_considered(context), rows_of(context, QueryKind.LABEL)
        entropy = prediction_entropy(context.probabilities)
        utilities[rows] = (entropy if self._repeats else np.where(context.labelled, np.nan, entropy))[: len(rows)]
        return choose_best(context, utilities, rng)
