"""Queries, answers, and what becomes of a query."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

NO_SYMBOL = 'none'
"""The answer that a thing belongs to no symbol, or that no thing here belongs to the symbol."""


class QueryKind(str, Enum):
    """The communicative actions of section 2.1 of the paper, and the relevance query, which the paper does not have."""

    LABEL = 'label'
    DEMONSTRATION = 'demonstration'
    FEATURE_SUBSET = 'feature_subset'
    NO_QUERY = 'no_query'
    # Last, as recorded decisions hold the positions.
    RELEVANCE = 'relevance'


class Outcome(str, Enum):
    """Outcome of a query; no teacher says that it was left unanswered."""

    ANSWERED = 'answered'
    UNKNOWN = 'unknown'
    SKIP = 'skip'
    UNANSWERED = 'unanswered'


SAYABLE_OUTCOMES = (Outcome.ANSWERED, Outcome.UNKNOWN, Outcome.SKIP)
"""Outcomes that an answer can have."""


@dataclass(frozen=True)
class Action:
    """A candidate of a turn: LQ(x) names an object, DQ(y) a symbol, all others neither."""

    kind: QueryKind
    object_id: int | None = None
    symbol: str | None = None


@dataclass(frozen=True)
class Query:
    """A question that was put to the teacher.

    Attributes:
        query_id: unique within the episode.
        turn: 1-based turn in which it was asked.
        choices: answers that count: symbols, object ids as text, or feature groups.
        cost: what it takes from the budget.
        budget_left: budget after this query.
        turns_left: turns after this one.
        model_version: how often the models had been fitted when it was asked.
        text: the question in plain English.
        known: of a demonstration query, ids of the things in the scene that have been named as they look now: another
            one is of more use. None of other queries, and where it is not told.
    """

    query_id: str
    turn: int
    action: Action
    choices: tuple[str, ...]
    cost: float
    budget_left: float
    turns_left: int
    model_version: int
    text: str
    known: tuple[int, ...] | None = None


Content = str | int | tuple[str, ...] | tuple[int, ...] | None


@dataclass(frozen=True)
class Answer:
    """Answer of a teacher.

    `content` is a symbol or `NO_SYMBOL` for a label query; an object id or `NO_SYMBOL` for a demonstration query;
    feature groups for a feature subset query; for a relevance query the ids of the objects that are of some symbol, of
    which there may be none; None unless the outcome is `ANSWERED`. `replaces` is None, or the `answer_id` of an answer
    to the same query that was accepted before and was wrong: this is what is said now.
    """

    query_id: str
    answer_id: str
    teacher_id: str
    outcome: Outcome
    content: Content = None
    replaces: str | None = None


@dataclass(frozen=True)
class QueryRecord:
    """One query of an episode and what came of it: a line of `queries` in the episode's JSON.

    `turn` is that of the question; `answered_in` is the turn during which its answer came if that was a later one.
    `objects` are the ids that the answer to a relevance query names; None of other queries, and without an answer.
    """

    turn: int
    kind: QueryKind
    object_id: int | None
    symbol: str | None
    cost: float
    outcome: Outcome
    groups: tuple[str, ...] = ()
    answered_in: int | None = None
    objects: tuple[int, ...] | None = None


DECISION_FEATURES = (
    'discriminability',
    'class_uniformity',
    'instance_variation',
    'prediction_margin',
    'budget_consumption',
    'remaining_time',
    'non_query_time',
)
"""The seven decision features of the paper, in the order in which every decision tells them."""


@dataclass(frozen=True, eq=False)
class Decision:
    """Choice of the questioner in a turn, and the candidates that it weighed.

    Attributes:
        turn: 1-based.
        candidates: C actions.
        features: (C, 7) expected decision features in the order of `DECISION_FEATURES`; NaN where the strategy
            computed none.
        utilities: (C,) the strategy's value of each candidate; NaN for a candidate that the strategy never considers.
        chosen: index into `candidates`.
        query: the question, or None if nothing is asked this turn.
    """

    turn: int
    candidates: tuple[Action, ...]
    features: NDArray[np.float64]
    utilities: NDArray[np.float64]
    chosen: int
    query: Query | None
