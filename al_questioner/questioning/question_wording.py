"""Wording of the queries, in plain English."""

from __future__ import annotations

from collections.abc import Sequence

from al_questioner.domain import Action, QueryKind


def question_text(action: Action, symbols: Sequence[str]) -> str:
    """Return the question in plain English.

    Raises:
        ValueError: the action asks nothing.
    """
    if action.kind is QueryKind.LABEL:
        return f'What is object {action.object_id}?'
    if action.kind is QueryKind.DEMONSTRATION:
        noun = _spoken(str(action.symbol))
        article = 'some' if noun.endswith('s') else 'an' if noun[0].lower() in 'aeiou' else 'a'
        return f'Can you show me {article} {noun}?'
    if action.kind is QueryKind.FEATURE_SUBSET:
        spoken = [_spoken(symbol) for symbol in symbols]
        names = f'{", ".join(spoken[:-1])} and {spoken[-1]}'
        return f'Which properties matter for telling {names} apart?'
    if action.kind is QueryKind.RELEVANCE:
        return 'Which of these things matter?'
    raise ValueError('NQ asks nothing')


def _spoken(symbol: str) -> str:
    return symbol.replace('_', ' ')
