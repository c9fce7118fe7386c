"""What a person types or sends with nothing but `ros2 topic pub`, read as an answer to the pending query."""

from __future__ import annotations

import re

from al_questioner.domain import NO_SYMBOL, Answer, AnswerError, Content, Outcome, Query, QueryKind

UNKNOWN_WORDS = frozenset({'?', 'unknown'})
SKIP_WORDS = frozenset({'skip'})


def read_plain_answer(text: str, query: Query, teacher_id: str = 'plain') -> Answer:
    """The answer that a plain word gives.

    `snack` answers a label query, `7`, `#7` or `object 7` a demonstration query, `colour,weight` a feature subset
    query; `none` says that a thing belongs to no symbol, or that no such thing is here; `?` is unknown, `skip` skips.

    Raises:
        AnswerError: the text is no answer to this query; the reason names what would be one.
    """
    word = text.strip()
    answer_id = f'{query.query_id}/{teacher_id}'
    if word.lower() in UNKNOWN_WORDS:
        return Answer(query.query_id, answer_id, teacher_id, Outcome.UNKNOWN)
    if word.lower() in SKIP_WORDS:
        return Answer(query.query_id, answer_id, teacher_id, Outcome.SKIP)
    return Answer(query.query_id, answer_id, teacher_id, Outcome.ANSWERED, _content(word, query))


def _content(word: str, query: Query) -> Content:
    if query.action.kind is QueryKind.FEATURE_SUBSET:
        parts = [part.strip() for part in word.split(',') if part.strip()]
        return tuple(_choice(part, query) for part in parts or [word])
    if query.action.kind is QueryKind.DEMONSTRATION and word.lower() != NO_SYMBOL:
        return int(_choice(re.sub(r'^(object\s*|#)', '', word, flags=re.IGNORECASE), query))
    return _choice(word, query)


def _choice(word: str, query: Query) -> str:
    """The choice that a word means, whatever its case."""
    nothing = () if query.action.kind is QueryKind.FEATURE_SUBSET else (NO_SYMBOL,)
    for choice in query.choices + nothing:
        if word.lower() == choice.lower():
            return choice
    expected = ', '.join((*query.choices, *nothing, '?', 'skip'))
    raise AnswerError(f'{word!r} does not answer {query.text!r}; expected one of: {expected}')
