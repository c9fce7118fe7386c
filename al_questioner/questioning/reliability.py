"""Reliability of each teacher, judged by the beliefs of the models before each answer.

The one-coin model of Dawid and Skene (1979), with the beliefs of the classifiers as prior of the label of an object, as
in Raykar et al. (2010). A teacher t names the right one of L labels with probability r_t, and each wrong one with
(1 - r_t) / (L - 1). Expectation maximisation alternates

    P(z_i = l) proportional to b_il prod_t (r_t if t said l, else (1 - r_t) / (L - 1)),
    r_t = (a + sum of P(z_i = the label that t gave i)) / (a + c + number of i that t labelled),

with a = 9 and c = 1: nine right answers and a wrong one that every teacher is credited with. If the models know
nothing, b is uniform, and nothing is learnt of a teacher whose objects no other teacher labels.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.domain import NO_SYMBOL, Answer, Knowledge, Lesson, Outcome, Query, QueryKind, TeacherCounts
from al_questioner.questioning.answers import AnswerHistory
from al_questioner.support.arrays import Array

CREDIT_RIGHT, CREDIT_WRONG = 9.0, 1.0
"""Number of right and wrong answers that every teacher is credited with before the first answer."""
CONVERGED = 1e-6
MOST_ITERATIONS = 1000
LEAST_BELIEF = 1e-9
"""Smallest belief in a label: a label that the models exclude can still be the right one."""


@dataclass(frozen=True)
class Statement:
    """A label, by its index, that a teacher gave to one object; `item` is the turn of the query about the object."""

    item: int
    teacher_id: str
    label: int


@dataclass(frozen=True)
class TeacherRecord:
    """Counts of a teacher's answers so far, and the teacher's reliability.

    Attributes:
        answered: answers that count now.
        unknown: queries of which the teacher did not know the answer.
        skipped: queries that the teacher skipped.
        corrected: answers of this teacher that were replaced.
        late: answers to queries that already had another answer.
        reliability: estimated probability that a label of this teacher is right.
    """

    answered: int
    unknown: int
    skipped: int
    corrected: int
    late: int
    reliability: float


def label_beliefs(probabilities: Array) -> Array:
    """Return (L,) probability of each symbol, and of none as the last, from (L - 1,) independent q_y(x).

    Exactly one of them is true, so that p(y) is proportional to q_y / (1 - q_y), and p(none) to 1.
    """
    q = np.clip(probabilities, LEAST_BELIEF, 1.0 - LEAST_BELIEF)
    odds = np.append(q / (1.0 - q), 1.0)
    return np.asarray(odds / odds.sum())


def reliabilities(
    statements: Sequence[Statement], beliefs: Mapping[int, Array], others: Iterable[str] = ()
) -> dict[str, float]:
    """Return the estimated r_t of every teacher, see the formulas above, given (L,) b_i of every item.

    Other teachers made no statement: of them only what every teacher is credited with is known.
    """
    credited = dict.fromkeys(others, CREDIT_RIGHT / (CREDIT_RIGHT + CREDIT_WRONG))
    if not statements:
        return credited
    teachers = list(dict.fromkeys(statement.teacher_id for statement in statements))
    items = list(dict.fromkeys(statement.item for statement in statements))
    who = np.array([teachers.index(statement.teacher_id) for statement in statements])
    which = np.array([items.index(statement.item) for statement in statements])
    said = np.array([statement.label for statement in statements])
    log_prior = np.log(np.maximum([beliefs[item] for item in items], LEAST_BELIEF))
    labels = log_prior.shape[1]
    spoken = np.bincount(who, minlength=len(teachers))
    reliability = np.full(len(teachers), CREDIT_RIGHT / (CREDIT_RIGHT + CREDIT_WRONG))
    for _ in range(MOST_ITERATIONS):
        log_posterior = log_prior.copy()
        wrong = np.log((1.0 - reliability[who]) / (labels - 1))
        np.add.at(log_posterior, which, wrong[:, None])
        np.add.at(log_posterior, (which, said), np.log(reliability[who]) - wrong)
        posterior = np.exp(log_posterior - log_posterior.max(axis=1, keepdims=True))
        posterior /= posterior.sum(axis=1, keepdims=True)
        right = np.bincount(who, weights=posterior[which, said], minlength=len(teachers))
        before, reliability = reliability, (CREDIT_RIGHT + right) / (CREDIT_RIGHT + CREDIT_WRONG + spoken)
        if np.abs(reliability - before).max() < CONVERGED:
            break
    return credited | dict(zip(teachers, reliability.tolist(), strict=True))


def statements_of(
    book: AnswerHistory, queries: Mapping[str, Query], symbols: Sequence[str], beliefs: Collection[int]
) -> list[Statement]:
    """Return the labels that the answers give to objects, including late answers.

    A late demonstration is left out, since it may show another object than the accepted one. There are beliefs of the
    turns in which one object was asked about or shown, and named; the last label is `NO_SYMBOL`.
    """
    labels = (*symbols, NO_SYMBOL)
    taken = [(answer, queries[answer.query_id]) for answer in book.standing()]
    late = [(answer, queries[answer.query_id]) for answer in book.late]
    said = taken + [(answer, query) for answer, query in late if query.action.kind is QueryKind.LABEL]
    named = [
        (query.turn, answer.teacher_id, answer.content if query.action.kind is QueryKind.LABEL else query.action.symbol)
        for answer, query in said
        if query.turn in beliefs and answer.outcome is Outcome.ANSWERED
    ]
    return [Statement(turn, who, labels.index(str(what))) for turn, who, what in named if what in labels]


def view_in_question(lesson: Lesson) -> int | None:
    """Return the number of the view of which a lesson says what it is; None if it is about none, or about many."""
    if lesson.kind not in (QueryKind.LABEL, QueryKind.DEMONSTRATION) or len(lesson.said) != 1:
        return None
    return lesson.said[0].view


def statements_in(knowledge: Knowledge, symbols: Sequence[str]) -> list[Statement]:
    """Return the labels that teachers gave in earlier episodes, hearsay included; items are `item_of` a lesson."""
    labels = (*symbols, NO_SYMBOL)
    about = [(item_of(index), lesson) for index, lesson in enumerate(knowledge.lessons) if view_in_question(lesson)]
    taken = [(item, lesson.teacher, lesson.said[0].label) for item, lesson in about]
    heard = [
        (item, said.teacher, said.label)
        for item, lesson in about
        for said in lesson.hearsay
        if said.view == view_in_question(lesson)
    ]
    return [Statement(item, who, labels.index(what)) for item, who, what in taken + heard if who and what in labels]


def item_of(lesson: int) -> int:
    """Return the item that a lesson of an earlier episode, by its index, is about; turns are numbers above 0."""
    return -1 - lesson


def teacher_records(
    book: AnswerHistory,
    queries: Mapping[str, Query],
    symbols: Sequence[str],
    beliefs: Mapping[int, Array],
    known: Knowledge | None = None,
) -> dict[str, TeacherRecord]:
    """Return the record of every teacher, in the order of their names.

    Args:
        book: what was said in the episode.
        queries: by their ids.
        symbols: of the episode.
        beliefs: (L,) of the models about what was named, before it was, by the turn or by `item_of` a lesson.
        known: what teachers said in earlier episodes.
    """
    statements = statements_of(book, queries, symbols, beliefs)
    if known is not None:
        statements = [*statements_in(known, symbols), *statements]
    counts, earlier = answer_counts(book), {} if known is None else known.teachers
    names = sorted({*counts, *earlier})
    estimated = reliabilities(statements, beliefs, names)
    return {
        name: TeacherRecord(
            **vars(counts.get(name, TeacherCounts()).plus(earlier.get(name, TeacherCounts()))),
            reliability=estimated[name],
        )
        for name in names
    }


def answer_counts(book: AnswerHistory) -> dict[str, TeacherCounts]:
    """Return the counts of every teacher's answers in an episode, in the order of their names."""
    standing, replaced, late = list(book.standing()), list(book.replaced()), list(book.late)

    def count(answers: Sequence[Answer], name: str, outcome: Outcome | None = None) -> int:
        return sum(a.teacher_id == name and outcome in (None, a.outcome) for a in answers)

    return {
        name: TeacherCounts(
            answered=count(standing, name, Outcome.ANSWERED),
            unknown=count(standing, name, Outcome.UNKNOWN),
            skipped=count(standing, name, Outcome.SKIP),
            corrected=count(replaced, name),
            late=count(late, name),
        )
        for name in sorted({answer.teacher_id for answer in (*replaced, *standing, *late)})
    }
