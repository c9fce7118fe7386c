"""The scripted expert: how a person who knows what is scarce would ask (section 4.3 of the paper)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Action, QueryKind
from al_questioner.questioning.candidates import is_affordable, is_open
from al_questioner.questioning.strategies.choice import Choice, choose_best, has_asked, rows_of, settled_actions
from al_questioner.questioning.strategies.decision_features import symbol_given_object
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.turn_context import TurnContext

LATEST_SUBSET_TURN = 5
"""By the end of this turn the expert has asked which features matter."""

HEAD_START = 1.0
"""Label queries by which it may run ahead of an even pace, at most; how many it does in a turn is drawn at random."""

MISSED = 2
"""An example of a symbol without any is asked for once another symbol has so many."""


class ScriptedExpert:
    """What the paper says of its expert, an author, as rules; a little random.

    - The feature subset query comes in one of the first five turns.
    - The budget is spread evenly over the time, so that each change of the scene finds some left.
    - Nearly all other queries are for labels, the cheapest: of the unlabelled view most likely to be an example of the
      symbol with the fewest. A demonstration is asked for only if a symbol is still without one when others have two.

    The choice carries the expected decision features of all candidates: it is a demonstration to learn from. The
    utility is 1 for what the rules single out and 0 for all else.
    """

    selector = None

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """What the rules say, ties broken at random; nothing if they say nothing."""
        preferred = self._preferred(context, rng)
        utilities = np.zeros(len(context.candidates))
        utilities[preferred if len(preferred) else rows_of(context, QueryKind.NO_QUERY)] = 1.0
        return choose_best(context, utilities, rng, expected_features(context))

    def _preferred(self, context: TurnContext, rng: np.random.Generator) -> NDArray[np.intp]:
        """Rows of the candidates that the rules single out, of which one is taken; none if nothing is to be asked."""
        subset = rows_of(context, QueryKind.FEATURE_SUBSET)
        if len(subset) and not has_asked(context, QueryKind.FEATURE_SUBSET):
            turns_left = LATEST_SUBSET_TURN - context.turn
            if rng.random() * (turns_left + 1) < 1:
                return subset
        due = self._due(context) + rng.random() * HEAD_START * context.costs.label
        settled = settled_actions(context)
        missing = self._missed_symbol(context, settled)
        if missing is not None and is_affordable(context.costs.demonstration, due):
            return rows_of(context, QueryKind.DEMONSTRATION)[missing : missing + 1]
        labels = rows_of(context, QueryKind.LABEL)
        is_open = np.array([context.candidates[row] not in settled for row in labels], dtype=bool)
        if not len(labels) or not is_affordable(context.costs.label, due):
            return labels[:0]
        fresh = np.flatnonzero(is_open & ~context.labelled)
        if not len(fresh):
            return fresh
        positives = np.array(list(context.concepts.positives.values()))
        rarest = positives == positives.min()
        likely = symbol_given_object(context.probabilities)[fresh][:, rarest].sum(axis=1)
        best: NDArray[np.intp] = labels[fresh[likely >= likely.max() - 1e-9]]
        return best

    def _due(self, context: TurnContext) -> float:
        """What an even pace leaves to spend by the end of this turn, the price of the subset query set aside."""
        will_ask = is_open(QueryKind.FEATURE_SUBSET, context.scene)
        subset = min(context.costs.feature_subset, context.budget) if will_ask else 0.0
        spent = context.spent - (subset if has_asked(context, QueryKind.FEATURE_SUBSET) else 0.0)
        return (context.budget - subset) * context.turn / context.turns - spent

    def _missed_symbol(self, context: TurnContext, settled: set[Action]) -> int | None:
        """Index of a symbol that still has no example when others have `MISSED`; not if it is not here to be shown."""
        counts = list(context.concepts.positives.values())
        if max(counts) < MISSED:
            return None
        tried = {
            record.symbol
            for record in context.history
            if record.kind is QueryKind.DEMONSTRATION and record.turn >= context.scene_turn
        }
        for index, (symbol, count) in enumerate(zip(context.symbols, counts, strict=True)):
            is_settled = Action(QueryKind.DEMONSTRATION, symbol=symbol) in settled
            if count == 0 and symbol not in tried and not is_settled:
                return index
        return None
