"""Strategy `farthest_fsq`: labels that are spread over the feature space."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.turn_context import TurnContext


class Farthest(UnlabelledFirst):
    """Strategy that labels the view farthest from all labelled ones, in the chosen features."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) distances to the nearest labelled view."""
        return context.concepts.distance_to_labelled(context.scene)
