"""Strategy `random_fsq`: random labels, the lower limit for any rule."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.turn_context import TurnContext


class RandomLabel(UnlabelledFirst):
    """Strategy that labels any view that is not labelled yet."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) the same value for all."""
        return np.zeros(len(context.scene))
