"""Base of the decision-theoretic strategies of the paper."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from al_questioner.domain import DECISION_FEATURES, QueryKind, SettingsError
from al_questioner.questioning.strategies.choice import Choice, choose_best, rows_of
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.turn_context import TurnContext


class DecisionTheoretic:
    """Strategy that takes the candidate of largest expected utility w . E[phi | a] (equations 1 and 2 of the paper).

    A decision feature without a weight has weight 0.

    Attributes:
        weight_names: the decision features that it uses.

    Raises:
        SettingsError: no weights.
    """

    selector = None
    name: ClassVar[str]
    weight_names: ClassVar[tuple[str, ...]]

    def __init__(self, weights: Mapping[str, float]) -> None:
        if not weights:
            ship = f"EpisodeSettings(..., weights=load_weights('{self.name}')) has those that ship"
            some = ', '.join(self.weight_names)
            raise SettingsError(f'strategy {self.name} needs weights for some of {some}: {ship}')
        self.weights = np.array([float(weights.get(feature, 0.0)) for feature in DECISION_FEATURES])

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the best of the paper's candidates; the choice carries the expected features of all."""
        features = expected_features(context)
        utilities = features @ self.weights
        # What its answer would change cannot be imagined, so it seems to be worth no more than asking something.
        utilities[rows_of(context, QueryKind.RELEVANCE)] = np.nan
        return choose_best(context, utilities, rng, features)
