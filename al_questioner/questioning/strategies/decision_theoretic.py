"""Decision-theoretic strategies of the paper: `dt_iros`, `dt_task` and `dt_task_env`."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import DECISION_FEATURES, SettingsError
from al_questioner.questioning.strategies.choice import Choice, choose_best
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.turn_context import TurnContext

IROS_FEATURES = DECISION_FEATURES[:2]
TASK_FEATURES = DECISION_FEATURES[:4]


class DecisionTheoretic:
    """Strategy that takes the candidate of largest expected utility w . E[phi | a] (equations 1 and 2 of the paper)."""

    selector = None

    def __init__(self, weights: NDArray[np.float64]) -> None:
        self.weights = weights

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the best of all candidates; the choice carries their expected features."""
        features = expected_features(context)
        return choose_best(context, features @ self.weights, rng, features)


def decision_theoretic(name: str, used: tuple[str, ...], weights: Mapping[str, float]) -> DecisionTheoretic:
    """Return a decision-theoretic strategy with weights by decision feature; a feature without a weight has weight 0.

    Raises:
        SettingsError: no weights, or a weight for a feature that this strategy does not use.
    """
    if not weights:
        ship = f"EpisodeSettings(..., weights=load_weights('{name}')) has those that ship"
        raise SettingsError(f'strategy {name} needs weights for some of {", ".join(used)}: {ship}')
    for feature, weight in weights.items():
        if feature not in used and weight != 0:
            raise SettingsError(f'strategy {name} does not use {feature!r}; it uses {", ".join(used)}')
    return DecisionTheoretic(np.array([float(weights.get(feature, 0.0)) for feature in DECISION_FEATURES]))
