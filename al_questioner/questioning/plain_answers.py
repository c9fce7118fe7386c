"""Answers in plain words, as people type them or send them with `ros2 topic pub`."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Collection

from al_questioner.domain import NO_SYMBOL, Answer, AnswerError, Content, Outcome, Query, QueryKind
from al_questioner.domain.names import COMMAS, meant, parted, quoted, suggestion
from al_questioner.domain.reserved_words import SKIP_WORDS, UNKNOWN_WORDS
from al_questioner.domain.spelling import composed

OUTCOMES = {**dict.fromkeys(UNKNOWN_WORDS, Outcome.UNKNOWN), **dict.fromkeys(SKIP_WORDS, Outcome.SKIP)}
"""Words that mean an outcome other than an answer, at every question."""


def read_plain_answer(text: str, query: Query, teacher_id: str = 'plain', others: Collection[str] = ()) -> Answer:
    """Read the answer that a plain word gives.

    `snack` answers a label query, `7`, `#7` or `object 7` a demonstration query, `colour,weight` a feature subset
    query, `3,10,27` a relevance query; `none` says that a thing belongs to no symbol, that no such thing is here, or
    that nothing here matters; `?` is unknown, `skip` skips.
    What is exactly a choice is that choice, whatever else the word may mean. Where it is no answer, the explanation
    considers other words, too, that the person may have meant.

    Raises:
        AnswerError: the text is no answer to this query, or may mean two; the reason names what would be one.
    """
    content = _content(text, query, others)
    outcome = Outcome.ANSWERED
    if isinstance(content, Outcome):
        outcome, content = content, None
    return Answer(query.query_id, f'{query.query_id}/{teacher_id}', teacher_id, outcome, content)


def respelt(answer: Answer, names: Collection[str]) -> Answer:
    """Return the answer with its names in the learner's form of Unicode."""
    content = answer.content
    if isinstance(content, str):
        return dataclasses.replace(answer, content=_known(content, names))
    if isinstance(content, tuple) and any(isinstance(part, str) for part in content):
        return dataclasses.replace(answer, content=tuple(_known(str(name), names) for name in content))
    return answer


def _known(name: str, names: Collection[str]) -> str:
    return name if name in names else next((known for known in names if composed(known) == composed(name)), name)


def _content(text: str, query: Query, others: Collection[str]) -> Content | Outcome:
    kind = query.action.kind
    found = meant(text, _words(query))
    if not found and kind is QueryKind.DEMONSTRATION:
        found = meant(re.sub(r'^\s*(object|#)\s*#?', '', text, flags=re.IGNORECASE), query.choices)
    if not found and kind is QueryKind.FEATURE_SUBSET:
        return tuple(_only(part, meant(part, query.choices), query, others) for part in _parts(text, query))
    if not found and kind is QueryKind.RELEVANCE:
        return tuple(_id_of(_only(part, meant(part, query.choices), query, others)) for part in _numbers(text, query))
    word = _only(text, found, query, others)
    if kind is QueryKind.RELEVANCE and word == NO_SYMBOL:
        return ()
    if word not in query.choices:
        return OUTCOMES.get(word, word)
    if kind is QueryKind.RELEVANCE:
        return (_id_of(word),)
    return _id_of(word) if kind is QueryKind.DEMONSTRATION else (word,) if kind is QueryKind.FEATURE_SUBSET else word


def _words(query: Query) -> tuple[str, ...]:
    """Return the words that answer a query."""
    return (*query.choices, *_other_words(query))


def _other_words(query: Query) -> tuple[str, ...]:
    nothing = () if query.action.kind is QueryKind.FEATURE_SUBSET else (NO_SYMBOL,)
    return (*nothing, *OUTCOMES)


def _only(text: str, found: list[str], query: Query, others: Collection[str]) -> str:
    """Return the one name that a text means."""
    word = quoted(text.strip())
    if len(found) > 1:
        raise AnswerError(f'{word} could be {" or ".join(found)}: write it exactly so')
    if found:
        return found[0]
    # A number that is like another one is not what was meant: it would name another thing.
    is_word = any(letter.isalpha() for letter in text)
    hint = suggestion(text, query.choices, (*_other_words(query), *others)) if is_word else ''
    amount = 'numbers with commas between, of' if query.action.kind is QueryKind.RELEVANCE else 'one of'
    expected = ', '.join(choice for choice in _words(query) if choice != 'unknown')
    raise AnswerError(f'{word} does not answer {query.text!r}{hint}; expected {amount}: {expected}')


def _id_of(word: str) -> int:
    """Return the object that a choice stands for."""
    try:
        return int(word)
    except ValueError as error:
        raise AnswerError(f'{quoted(word)} is no number of an object') from error


def _numbers(text: str, query: Query) -> list[str]:
    """Split a text into the numbers of objects that it names, at commas, blanks or `and`; a `#` before one is left out.

    A text without any is returned whole.
    """
    parts = re.split(rf'[\s{COMMAS}]+', re.sub(r'\b(objects?|and)\b|#', ' ', text, flags=re.IGNORECASE))
    parts = [part for part in parts if part]
    if len(parts) > 1 and any(meant(part, _other_words(query)) for part in parts):
        alone = ', '.join(word for word in _other_words(query) if word != 'unknown')
        raise AnswerError(f'{quoted(text.strip())} does not answer {query.text!r}: each of {alone} stands alone')
    return parts or [text]


def _parts(text: str, query: Query) -> list[str]:
    """Split a text into the groups that it names, at commas; a name may hold one itself."""
    parts = parted(text) or [text]
    if '"' in text or not any(',' in choice for choice in query.choices):
        return parts
    pieces, longest, first = text.split(','), [], 0
    while first < len(pieces):
        spans = {last: ','.join(pieces[first:last]).strip() for last in range(len(pieces), first, -1)}
        last = next((last for last, span in spans.items() if meant(span, query.choices)), first + 1)
        longest.append(spans[last])
        first = last
    longest = [span for span in longest if span]
    if longest != parts and all(meant(part, query.choices) for part in parts):
        raise AnswerError(f'{quoted(text.strip())} can be read in two ways: put each name in quotes')
    return longest or parts
