"""Answers as sentences in plain English."""

from __future__ import annotations

from collections.abc import Sequence

from al_questioner.domain import NO_SYMBOL, Action, Answer, Outcome, QueryKind, QueryRecord
from al_questioner.support.safe_text import printable


def said_in_words(action: Action, answer: Answer) -> str:
    """Return an answer to a question as a sentence."""
    if answer.outcome is not Outcome.ANSWERED:
        return _unanswered(action, answer.outcome)
    content = answer.content
    if action.kind is QueryKind.RELEVANCE:
        return _mattering(tuple(content) if isinstance(content, tuple) else ())
    if isinstance(content, tuple):
        return f'what matters is {_listed(content)}'
    if action.kind is QueryKind.LABEL:
        return _is(action.object_id, str(content))
    return _shown(action.symbol, None if content == NO_SYMBOL else int(str(content)))


def recorded_in_words(record: QueryRecord) -> str:
    """Return the result of an earlier question, from the learner's records, as a sentence."""
    if record.outcome is not Outcome.ANSWERED:
        return _unanswered(Action(record.kind, record.object_id, record.symbol), record.outcome)
    if record.kind is QueryKind.FEATURE_SUBSET:
        return f'what matters is {_listed(record.groups)}'
    if record.kind is QueryKind.RELEVANCE:
        return _mattering(record.objects or ())
    if record.kind is QueryKind.LABEL:
        return _is(record.object_id, str(record.symbol))
    return _shown(record.symbol, record.object_id)


def _unanswered(action: Action, outcome: Outcome) -> str:
    about = {
        QueryKind.LABEL: f'object {action.object_id}',
        QueryKind.DEMONSTRATION: _name(action.symbol),
        QueryKind.FEATURE_SUBSET: 'what matters',
        QueryKind.RELEVANCE: 'which things matter',
    }.get(action.kind, '')
    said = {Outcome.UNKNOWN: 'you do not know', Outcome.SKIP: 'skipped'}
    return f'{about}: {said.get(outcome, "nobody answered")}'


def _is(object_id: int | None, symbol: str) -> str:
    return f'object {object_id} is ' + ('none of these' if symbol == NO_SYMBOL else _name(symbol))


def _shown(symbol: str | None, object_id: int | None) -> str:
    return f'{_name(symbol)}: ' + ('none is here' if object_id is None else f'object {object_id}')


def _mattering(objects: Sequence[object]) -> str:
    return 'of these things ' + (
        f'{_listed(objects)} {"matters" if len(objects) == 1 else "matter"}' if objects else 'none matters'
    )


def _listed(names: Sequence[object]) -> str:
    return printable(', '.join(map(str, names)), 200)


def _name(symbol: str | None) -> str:
    return printable(str(symbol), 60)
