"""`random_fsq`: what any rule must beat."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.turn_context import TurnContext


class RandomLabel(UnlabelledFirst):
    """Any view that is not labelled yet."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """(|X|,) the same for all."""
        return np.zeros(len(context.scene))
