"""What was said to each query: which answers were taken, which came too late, and what an answer says."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from al_questioner.domain import (
    NO_SYMBOL,
    SAYABLE_OUTCOMES,
    Action,
    Answer,
    AnswerError,
    LateAnswerError,
    Outcome,
    Query,
    QueryKind,
    Scene,
)


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
        """The answer to each query that holds now: the last, if some were replaced."""
        for answers in self._taken.values():
            yield answers[next(reversed(answers))]

    def replaced(self) -> Iterator[Answer]:
        """The answers that were replaced."""
        for answers in self._taken.values():
            yield from list(answers.values())[:-1]

    def has_taken(self, answer: Answer) -> bool:
        """Whether this very answer was taken before.

        Raises:
            AnswerError: another answer of the same ids was.
            LateAnswerError: its query was settled by an answer of another id, which it does not replace.
        """
        taken = self._taken.get(answer.query_id, {})
        same_id = taken.get(answer.answer_id)
        if same_id is not None and same_id != answer:
            raise AnswerError(f'another answer {answer.answer_id!r} to query {answer.query_id!r} was taken already')
        if taken and same_id is None and answer.replaces is None:
            first = next(iter(taken))
            raise LateAnswerError(f'query {answer.query_id!r} was answered already, by {first!r}')
        return same_id is not None

    def check_correction(self, answer: Answer) -> None:
        """Make sure that an answer can replace the one that it names.

        Raises:
            AnswerError: that was not taken, or was replaced already, or the id of this one is taken.
        """
        taken = self._taken.get(answer.query_id, {})
        if answer.replaces not in taken:
            raise AnswerError(f'no answer {answer.replaces!r} to query {answer.query_id!r} was taken')
        if answer.answer_id in taken:
            raise AnswerError(f'another answer {answer.answer_id!r} to query {answer.query_id!r} was taken already')
        last = next(reversed(taken))
        if answer.replaces != last:
            raise AnswerError(
                f'answer {answer.replaces!r} to query {answer.query_id!r} was replaced, in the end by {last!r}'
            )


def content_of(
    answer: Answer, action: Action, symbols: Sequence[str], groups: Sequence[str], scene: Scene
) -> tuple[int | None, str | None, tuple[str, ...]]:
    """Object, symbol and feature groups that a question and its answer speak of.

    Args:
        answer: what was said.
        action: what was asked.
        symbols: the concepts.
        groups: the feature groups.
        scene: of the turn in which it was asked.

    Raises:
        AnswerError: the answer does not fit the question.
    """
    if answer.outcome not in SAYABLE_OUTCOMES:
        raise AnswerError(f'nobody can say that a question is {answer.outcome.value}')
    if answer.outcome is not Outcome.ANSWERED:
        if answer.content is not None:
            raise AnswerError(f'an answer with outcome {answer.outcome.value!r} has no content')
        return action.object_id, action.symbol, ()
    if action.kind is QueryKind.LABEL:
        return action.object_id, _named_symbol(answer, symbols), ()
    if action.kind is QueryKind.DEMONSTRATION:
        return _shown_object(answer, scene), action.symbol, ()
    return None, None, _named_groups(answer, groups)


def _named_symbol(answer: Answer, symbols: Sequence[str]) -> str:
    """The symbol, or `NO_SYMBOL`, that an answer to a label query names."""
    known = (*symbols, NO_SYMBOL)
    if not isinstance(answer.content, str):
        raise AnswerError(f'a label is one of {", ".join(known)}, not {answer.content!r}')
    if answer.content not in known:
        raise AnswerError(f'unknown label {answer.content!r}; known: {", ".join(known)}')
    return answer.content


def _shown_object(answer: Answer, scene: Scene) -> int | None:
    """The object of the scene that an answer to a demonstration query shows; None if there is none to show."""
    if answer.content == NO_SYMBOL:
        return None
    if not isinstance(answer.content, int) or isinstance(answer.content, bool):
        raise AnswerError(f'a demonstration is an object id or {NO_SYMBOL!r}, not {answer.content!r}')
    if answer.content not in scene.object_ids:
        raise AnswerError(f'object {answer.content} is not in the scene')
    return answer.content


def _named_groups(answer: Answer, groups: Sequence[str]) -> tuple[str, ...]:
    """The feature groups that an answer to a feature subset query names, each once."""
    if not isinstance(answer.content, tuple) or not answer.content:
        raise AnswerError(f'a feature subset is some of {", ".join(groups)}, not {answer.content!r}')
    for group in answer.content:
        if group not in groups:
            raise AnswerError(f'unknown feature group {group!r}; known: {", ".join(groups)}')
    return tuple(dict.fromkeys(answer.content))
