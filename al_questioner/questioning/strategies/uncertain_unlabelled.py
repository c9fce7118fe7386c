"""Strategy `u_sampling_fsq`: uncertainty sampling with a feature subset query, which it does not have in the paper."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning.strategies.decision_features import prediction_entropy
from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.turn_context import TurnContext


class UncertainUnlabelled(UnlabelledFirst):
    """Strategy that labels the view of largest prediction entropy."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) entropy of p(y|x)."""
        return prediction_entropy(context.probabilities)
