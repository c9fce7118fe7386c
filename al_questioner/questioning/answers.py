"""Answers to the queries of an episode: accepted, replaced or late, and their meaning."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum

from al_questioner.domain import (
    NO_SYMBOL,
    SAYABLE_OUTCOMES,
    Action,
    Answer,
    AnswerError,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
    Scene,
)

LATE_KEPT = 100
"""Late answers to one query that are kept."""


class Receipt(Enum):
    """Outcome of handing in an answer that fits its query.

    It counts; it was taken before; or another answer had settled its query: then it is not learnt from, and only kept
    for what it tells of its teacher.
    """

    ACCEPTED = 'accepted'
    DUPLICATE = 'duplicate'
    LATE = 'late'


@dataclass(frozen=True)
class PreparedAnswer:
    """An answer that was checked, and what taking it will do.

    Attributes:
        record: what comes of its query; None if it is not accepted.
        reason: why it is not; empty if it is.
        is_kept: whether it changes anything: not if it was heard before, or if too many others are late as well.
    """

    answer: Answer
    receipt: Receipt
    record: QueryRecord | None = None
    reason: str = ''
    is_kept: bool = True


@dataclass(frozen=True)
class Told:
    """Content of a question and its answer: the attributes of these names of a `QueryRecord`."""

    object_id: int | None = None
    symbol: str | None = None
    groups: tuple[str, ...] = ()
    objects: tuple[int, ...] | None = None


class AnswerHistory:
    """The answers of an episode, in the order in which they were heard.

    Attributes:
        last: the one that was taken last, with its query; None before the first.
        late: those that came too late.
    """

    def __init__(self) -> None:
        self._taken: dict[str, dict[str, Answer]] = {}
        self.last: tuple[Query, Answer] | None = None
        self.late: dict[Answer, None] = {}

    def take(self, answer: Answer, query: Query) -> None:
        """Note an answer that counts, and the query that it is to."""
        self._taken.setdefault(answer.query_id, {})[answer.answer_id] = answer
        self.last = (query, answer)

    def keep_late(self, answer: Answer) -> None:
        """Note an answer to a query that another one had settled."""
        self.late[answer] = None

    def standing(self) -> Iterator[Answer]:
        """Return the valid answer to each query: the last one, if some were replaced."""
        for answers in self._taken.values():
            yield answers[next(reversed(answers))]

    def replaced(self) -> Iterator[Answer]:
        """Return the answers that were replaced."""
        for answers in self._taken.values():
            yield from list(answers.values())[:-1]

    def receipt_for(self, answer: Answer) -> Receipt:
        """Return what becomes of an answer, as far as the answers before tell.

        Raises:
            AnswerError: another answer of the same ids was taken, or this one corrects none that can be corrected.
        """
        taken = self._taken.get(answer.query_id, {})
        same_id = taken.get(answer.answer_id)
        if same_id == answer:
            return Receipt.DUPLICATE
        if same_id is not None:
            raise AnswerError(f'another answer {answer.answer_id!r} to query {answer.query_id!r} was taken already')
        if answer.replaces is None:
            return Receipt.LATE if taken else Receipt.ACCEPTED
        if answer.replaces not in taken:
            raise AnswerError(f'no answer {answer.replaces!r} to query {answer.query_id!r} was taken')
        last, to = next(reversed(taken)), f'query {answer.query_id!r}'
        if answer.replaces != last:
            raise AnswerError(f'answer {answer.replaces!r} to {to} was replaced, in the end by {last!r}')
        return Receipt.ACCEPTED

    def keeps_late(self, answer: Answer) -> bool:
        """Return whether a late answer is one to keep: it was not kept before, and not too many others were."""
        return answer not in self.late and sum(one.query_id == answer.query_id for one in self.late) < LATE_KEPT

    def why_not(self, answer: Answer, receipt: Receipt) -> str:
        """Return why an answer of this receipt does not count now; empty if it does."""
        if receipt is Receipt.LATE:
            return f'query {answer.query_id!r} was answered already, by {next(iter(self._taken[answer.query_id]))!r}'
        return 'already taken' if receipt is Receipt.DUPLICATE else ''


def content_of(answer: Answer, action: Action, symbols: Sequence[str], groups: Sequence[str], scene: Scene) -> Told:
    """Return what a question about a scene and its answer speak of.

    Raises:
        AnswerError: the answer does not fit the question.
    """
    if answer.outcome not in SAYABLE_OUTCOMES:
        raise AnswerError(f'nobody can say that a question is {answer.outcome.value}')
    if answer.outcome is not Outcome.ANSWERED:
        if answer.content is not None:
            raise AnswerError(f'an answer with outcome {answer.outcome.value!r} has no content')
        return Told(action.object_id, action.symbol)
    if action.kind is QueryKind.LABEL:
        return Told(action.object_id, _named_symbol(answer, symbols))
    if action.kind is QueryKind.DEMONSTRATION:
        return Told(_shown_object(answer, scene), action.symbol)
    if action.kind is QueryKind.RELEVANCE:
        return Told(objects=_named_objects(answer, scene))
    return Told(groups=_named_groups(answer, groups))


def _named_symbol(answer: Answer, symbols: Sequence[str]) -> str:
    """Return the symbol, or `NO_SYMBOL`, that an answer to a label query names."""
    known = (*symbols, NO_SYMBOL)
    if not isinstance(answer.content, str):
        raise AnswerError(f'a label is one of {", ".join(known)}, not {answer.content!r}')
    if answer.content not in known:
        raise AnswerError(f'unknown label {answer.content!r}; known: {", ".join(known)}')
    return answer.content


def _shown_object(answer: Answer, scene: Scene) -> int | None:
    """Return the object that an answer to a demonstration query shows; None if there is none to show."""
    if answer.content == NO_SYMBOL:
        return None
    if not isinstance(answer.content, int) or isinstance(answer.content, bool):
        raise AnswerError(f'a demonstration is an object id or {NO_SYMBOL!r}, not {answer.content!r}')
    if answer.content not in scene.object_ids:
        raise AnswerError(f'object {answer.content} is not in the scene')
    return answer.content


def _named_groups(answer: Answer, groups: Sequence[str]) -> tuple[str, ...]:
    """Return the feature groups that an answer to a feature subset query names, each once."""
    if not isinstance(answer.content, tuple) or not answer.content:
        raise AnswerError(f'a feature subset is some of {", ".join(groups)}, not {answer.content!r}')
    for group in answer.content:
        if group not in groups:
            raise AnswerError(f'unknown feature group {group!r}; known: {", ".join(groups)}')
    return tuple(dict.fromkeys(map(str, answer.content)))


def _named_objects(answer: Answer, scene: Scene) -> tuple[int, ...]:
    """Return the objects that an answer to a relevance query names, each once; none if nothing matters."""
    if not isinstance(answer.content, tuple):
        raise AnswerError(f'the things that matter are a list of object ids, not {answer.content!r}')
    named: list[int] = []
    for object_id in answer.content:
        if not isinstance(object_id, int) or isinstance(object_id, bool):
            raise AnswerError(f'the things that matter are object ids, not {object_id!r}')
        if object_id not in scene.object_ids:
            raise AnswerError(f'object {object_id} is not in the scene')
        named.append(object_id)
    return tuple(dict.fromkeys(named))
