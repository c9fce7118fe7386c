"""The interface of a strategy, and tools to choose the best candidate."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import takewhile
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import Selector
from al_questioner.domain import Action, InputError, Outcome, QueryKind
from al_questioner.questioning.turn_context import TurnContext

TIE = 1e-9
"""Candidates within this relative distance of the best are equal: the rest is rounding."""
NO_ANSWER = (Outcome.UNKNOWN, Outcome.SKIP)
"""Outcomes of a query that the teacher heard and did not answer."""


@dataclass(frozen=True, eq=False)
class Choice:
    """A strategy's choice among the candidates of a turn.

    Attributes:
        utilities: (C,) value of each candidate; NaN for one that the strategy does not consider.
        features: (C, F) of the candidates, if the strategy tells them: the seven of `DECISION_FEATURES`, unless it is
            observed with others.
    """

    index: int
    utilities: NDArray[np.float64]
    features: NDArray[np.float64] | None = None


@runtime_checkable
class Strategy(Protocol):
    """Decides what to ask. It keeps no state of its own: all it knows is in the context."""

    @property
    def selector(self) -> Selector | None:
        """Computational feature selection of the learner where no teacher names the features; None for none."""
        ...

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Choose one of `context.candidates`; ties are broken with `rng`."""


StrategyFactory: TypeAlias = Callable[[Mapping[str, float]], Strategy]
"""Makes a strategy from weights and constants by name, which are empty if none are given.

It declares their names as its attribute `weight_names`, and is handed no others. One that declares none is handed all.
"""


def weight_names(factory: StrategyFactory) -> tuple[str, ...] | None:
    """Return the names of the weights and constants that a strategy declares; None if it declares nothing."""
    return getattr(factory, 'weight_names', None)


def nothing_considered(context: TurnContext) -> NDArray[np.float64]:
    """Return (C,) utilities that are all NaN: no candidate is considered."""
    return np.full(len(context.candidates), np.nan)


def ask_nothing(context: TurnContext) -> Choice:
    """NQ, where nothing else is considered."""
    utilities = nothing_considered(context)
    # It costs nothing, so it is always there, as the last candidate.
    utilities[-1] = 0.0
    return Choice(len(utilities) - 1, utilities)


def choose_best(
    context: TurnContext,
    utilities: NDArray[np.float64],
    rng: np.random.Generator,
    features: NDArray[np.float64] | None = None,
) -> Choice:
    """Choose the candidate of largest utility, ties broken at random; ask nothing if none is considered.

    Whatever the strategy, what is settled is not considered. Expected utility knows nothing of that: an answer that
    teaches nothing leaves the beliefs as they were, so the same question would be the best again, and it does not tell
    asking something from asking something useful, so pointless questions would keep the non-query time low.

    The (C,) utilities are NaN for candidates that are not considered; the (C, F) features are handed on to the choice.
    """
    settled = settled_actions(context)
    considered = np.where([action in settled for action in context.candidates], np.nan, utilities)
    if np.isnan(considered).all():
        considered = ask_nothing(context).utilities
    best = np.nanmax(considered)
    ties = np.flatnonzero(considered >= best - TIE * abs(best))
    return Choice(int(rng.choice(ties)), considered, features)


def settled_actions(context: TurnContext) -> set[Action]:
    """Return the questions that it is pointless to ask again.

    That is the feature subset query once it has been asked, in this episode or before, or, if the teacher had no
    answer to it, asked twice; what the teacher did not know the name of, as long as it looks the same; what has one
    possible answer, which is known; and, until the scene changes, what the teacher skipped or did not know otherwise,
    and the symbols of which nothing is here: the teacher said so, or has named all things here otherwise. A question
    that nobody heard is not settled, but the feature subset query, which waits for a late answer.
    """
    unnameable = np.flatnonzero(context.concepts.is_unnameable(context.scene))
    settled = {Action(QueryKind.LABEL, context.scene.object_ids[row]) for row in unnameable}
    subset_queries = [record for record in context.history if record.kind is QueryKind.FEATURE_SUBSET]
    is_answered = context.concepts.subset_was_told or any(r.outcome not in NO_ANSWER for r in subset_queries)
    if len(subset_queries) > 1 or is_answered:
        settled.add(Action(QueryKind.FEATURE_SUBSET))
    for record in takewhile(lambda record: record.turn >= context.scene_turn, reversed(context.history)):
        if record.outcome in NO_ANSWER:
            settled.add(Action(record.kind, record.object_id, record.symbol))
    absent = context.absent_symbols | context.excluded_symbols
    return settled | context.known_answers | {Action(QueryKind.DEMONSTRATION, symbol=symbol) for symbol in absent}


def rows_of(context: TurnContext, kind: QueryKind) -> NDArray[np.intp]:
    """Rows of the candidates of this kind, in canonical order."""
    return np.flatnonzero([action.kind is kind for action in context.candidates])


def has_asked(context: TurnContext, kind: QueryKind) -> bool:
    """Return whether the teacher was asked a query of this kind in this episode, whatever its outcome."""
    return any(record.kind is kind for record in context.history)


def index_of(recorded: Action, context: TurnContext) -> int:
    """Return the index of a recorded choice among the candidates.

    Raises:
        InputError: it is not one of them.
    """
    if recorded not in context.candidates:
        raise InputError(f'{recorded} was chosen, which is not a candidate here')
    return context.candidates.index(recorded)
