"""Scripted expert, which asks like a person who knows which symbols are rare (section 4.3 of the paper)."""

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
"""Turn by whose end the expert has asked which features matter."""

HEAD_START = 1.0
"""Largest lead of the expert over an even pace, in label queries; the lead in a turn is drawn at random."""

MISSED = 2
"""Number of examples of one symbol from which a symbol without any is asked for."""


class ScriptedExpert:
    """Strategy with the rules by which the paper's expert, an author, asked; a little random.

    - The feature subset query comes in one of the first five turns.
    - The budget is spread evenly over the time, so that some is left at each change of the scene.
    - Nearly all other queries are for labels, the cheapest: of the unlabelled view most likely to be an example of the
      symbol with the fewest. A demonstration is asked for only if a symbol is still without one when others have two.

    The choice carries the expected decision features of all candidates, so it is a demonstration to learn from. The
    utility is 1 for the candidates that the rules select and 0 for all others.
    """

    selector = None

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the choice of the rules, with ties broken at random; no query if they select none."""
        preferred = self._preferred(context, rng)
        utilities = np.zeros(len(context.candidates))
        utilities[preferred if len(preferred) else rows_of(context, QueryKind.NO_QUERY)] = 1.0
        return choose_best(context, utilities, rng, expected_features(context))

    def _preferred(self, context: TurnContext, rng: np.random.Generator) -> NDArray[np.intp]:
        """Return the rows of the candidates that the rules select, of which one is taken; none for no query."""
        subset = rows_of(context, QueryKind.FEATURE_SUBSET)
        if len(subset) and _may_ask_for_subset(context) and not has_asked(context, QueryKind.FEATURE_SUBSET):
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
        """Return the amount that an even pace allows by the end of this turn, without the price of the subset query."""
        will_ask = is_open(QueryKind.FEATURE_SUBSET, context.scene) and _may_ask_for_subset(context)
        subset = min(context.costs.feature_subset, context.budget) if will_ask else 0.0
        spent = context.spent - (subset if has_asked(context, QueryKind.FEATURE_SUBSET) else 0.0)
        return (context.budget - subset) * context.turn / context.turns - spent

    def _missed_symbol(self, context: TurnContext, settled: set[Action]) -> int | None:
        """Return the index of a symbol without examples when others have `MISSED`, unless the scene cannot show one."""
        counts = list(context.concepts.positives.values())
        if max(counts) < MISSED:
            return None
        here = [record for record in context.history if record.turn >= context.scene_turn]
        tried = {record.symbol for record in here if record.kind is QueryKind.DEMONSTRATION}
        tried |= {action.symbol for action in settled if action.kind is QueryKind.DEMONSTRATION}
        missed = (index for index, symbol in enumerate(context.symbols) if not counts[index] and symbol not in tried)
        return next(missed, None)


def _may_ask_for_subset(context: TurnContext) -> bool:
    """Return whether the relevant features were not known before the episode."""
    return has_asked(context, QueryKind.FEATURE_SUBSET) or not context.concepts.subset_was_told
