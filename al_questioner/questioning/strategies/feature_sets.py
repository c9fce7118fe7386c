"""Features of each strategy whose weights imitation can learn."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import Selector
from al_questioner.domain import DECISION_FEATURES, QueryKind
from al_questioner.questioning.strategies.choice import Choice, Strategy
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.strategies.value_per_cost import VALUE_FEATURES, is_worthless, value_features
from al_questioner.questioning.turn_context import TurnContext


def _never(features: NDArray[np.float64]) -> NDArray[np.bool_]:
    return np.zeros(len(features), dtype=bool)


@dataclass(frozen=True)
class FeatureSet:
    """Features of the candidates; a strategy takes the candidate with the largest weighted sum of them.

    Attributes:
        of: function that returns the (C, F) features of the candidates of a turn.
        is_worthless: function that returns, for (C, F) features, (C,) booleans: the candidates never to consider.
        passed_over: kinds of queries that the strategy never considers, and whose features say nothing.
    """

    strategy: str
    names: tuple[str, ...]
    of: Callable[[TurnContext], NDArray[np.float64]]
    is_worthless: Callable[[NDArray[np.float64]], NDArray[np.bool_]] = _never
    passed_over: tuple[QueryKind, ...] = ()

    def left_out(self, context: TurnContext, features: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return (C,) whether the strategy does not consider candidates with these (C, F) features."""
        return self.is_worthless(features) | [action.kind in self.passed_over for action in context.candidates]


FEATURE_SETS: Mapping[str, FeatureSet] = {
    'dt_task_env': FeatureSet('dt_task_env', DECISION_FEATURES, expected_features, passed_over=(QueryKind.RELEVANCE,)),
    'value_per_cost': FeatureSet('value_per_cost', VALUE_FEATURES, value_features, is_worthless),
}
"""Feature sets by the name of the strategy."""


class FeatureRecorder:
    """Strategy whose choices carry the features of a feature set, so that they demonstrate how to weigh these.

    The strategy decides; whatever it computes itself, the features of the set are computed of every candidate. One that
    is worthless to the set, or passed over, counts as not considered, unless it is chosen.
    """

    def __init__(self, strategy: Strategy, feature_set: FeatureSet) -> None:
        self._strategy, self._feature_set = strategy, feature_set

    @property
    def selector(self) -> Selector | None:
        """Selector of the strategy."""
        return self._strategy.selector

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the strategy's choice, with the features of the set."""
        choice, features = self._strategy.choose(context, rng), self._feature_set.of(context)
        left_out = self._feature_set.left_out(context, features) & (np.arange(len(features)) != choice.index)
        return dataclasses.replace(choice, utilities=np.where(left_out, np.nan, choice.utilities), features=features)
