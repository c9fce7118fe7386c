"""Strategy `rarest_demo`: as many examples of each symbol."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import QueryKind
from al_questioner.questioning.candidates import is_affordable
from al_questioner.questioning.strategies.subset_first import SubsetFirst
from al_questioner.questioning.turn_context import TurnContext


class RarestDemonstration(SubsetFirst):
    """Strategy that asks for a demonstration of the symbol with the fewest examples, paced over the scenes.

    In a scene it does not ask again for a symbol if the teacher showed an object that it already knew.
    """

    kind = QueryKind.DEMONSTRATION

    def values(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|Y|,) minus the number of examples; NaN for a symbol that is exhausted here, or not due yet."""
        counts = np.array(list(context.concepts.positives.values()), dtype=np.float64)
        if context.labelled.all() or not is_affordable(context.costs.demonstration, context.allowance):
            return np.full(len(counts), np.nan)
        times_labelled = context.concepts.times_labelled(context.scene)
        here = (r for r in context.history if r.kind is QueryKind.DEMONSTRATION and r.turn >= context.scene_turn)
        shown = [(r.symbol, context.scene.index_of(r.object_id)) for r in here if r.object_id is not None]
        exhausted = {symbol for symbol, row in shown if times_labelled[row] > 1}
        return np.where([symbol in exhausted for symbol in context.symbols], np.nan, -counts)
