"""Names that people say: which can be told apart, and which is meant by what somebody typed."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cache

from al_questioner.domain.errors import InputError
from al_questioner.domain.reserved_words import KEYS, RESERVED
from al_questioner.domain.spelling import (
    JOINERS,
    composed,
    holds_word,
    in_latin,
    is_invisible,
    is_number,
    loosely,
    said,
    usual_form,
    without_accents,
)

COMMAS = ',،、'
"""Of ASCII and of other scripts."""
LONGEST_QUOTED = 60
"""Characters of what somebody typed that an explanation repeats."""
LONGEST_SAID = 1000
"""Characters; what is longer is a name only if it is one exactly."""
LIKENESS = 0.65
"""From which on a word is near a name, by the measure of difflib: one wrong letter of three."""
LIKENESS_OF_COMMANDS = 0.75
"""From which on it is near a command, which is rarely meant: two letters of four that changed places."""
_PARTS = re.compile(r'\s*"((?:[^"]|"")+)"\s*(?:,|$)|([^,]+)')


def listed(names: object) -> tuple[str, ...] | None:
    """The names, if it is a list of such; a text is none, although it holds texts."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        return None
    found = tuple(names)
    return tuple(map(str, found)) if all(isinstance(name, str) for name in found) else None


def check_names(names: Sequence[str], what: str, has_key: bool = True) -> None:
    """Make sure that people can say each of these names, and that nothing they say means two of them.

    Args:
        names: that are to be said, such as symbols.
        what: one of them is, for the text of the error.
        has_key: whether a single letter says one of them.

    Raises:
        InputError: a name that stands for something else, cannot be typed as it is, or is like another; the text names
            it and says why.
    """
    seen: dict[str, str] = {}
    for name in names:
        reason = unsayable(name, has_key)
        if reason:
            raise InputError(f'{quoted(name)} cannot be a {what}: {reason}')
        other = seen.setdefault(in_latin(said(name)), name)
        if other is not name:
            raise InputError(f'{quoted(name)} cannot be a {what} beside {quoted(other)}: said, they are the same')


def unsayable(name: str, has_key: bool = True) -> str:
    """Why people could not say a name, or would say something else by it; empty if they can."""
    unseen = next(filter(is_invisible, JOINERS.sub('', name)), None)
    if unseen is not None:
        return f'it holds the invisible character U+{ord(unseen):04X}'
    if not name.strip():
        return 'it is empty'
    if name != name.strip():
        return 'it begins or ends with a blank'
    word = _reserved_word(name)
    if word is not None and (has_key or word not in KEYS):
        return f'to the robot {word!r} {RESERVED[word]}'
    if is_number(name):
        return 'a number means an object'
    loose = loosely(name)
    if '"' in loose:
        return 'quotes mark where a name begins and ends'
    if any(comma in loose for comma in COMMAS):
        return 'a comma parts names'
    if loose.startswith('{'):
        return 'what begins with a brace is read as a JSON document'
    if not holds_word(name):
        return 'it holds no letter'
    if name != composed(name):
        return 'its Unicode is decomposed, letters apart from their accents (NFD): write it composed (NFC)'
    usual = usual_form(name)
    return '' if name == usual else f'it holds full-width or other unusual characters: write {usual!r}'


def _reserved_word(name: str) -> str | None:
    """The word of `RESERVED` that a name says or looks like, if there is one."""
    word = said(name)
    if not word:
        return '?' if set(loosely(name)) & {'?', '¿'} else None
    # A single letter of another alphabet is on another key.
    return _reserved_forms().get(word) or (_reserved_forms().get(in_latin(word)) if len(word) > 1 else None)


@cache
def _reserved_forms() -> Mapping[str, str]:
    """The reserved words by what is said of them, with and without their accents."""
    forms = {said(word): word for word in RESERVED}
    plain = {without_accents(form): word for form, word in forms.items()}
    return {form: word for form, word in {**plain, **forms}.items() if form}


def meant(word: str, names: Iterable[str]) -> list[str]:
    """Which of some names a word means: those that are exactly alike, else but for Unicode's forms, else loosely.

    Several if it is not clear; none if it is like none.
    """
    known = list(dict.fromkeys(names))
    for form in (str, str.strip, _trimmed, loosely)[: None if len(word) <= LONGEST_SAID else 1]:
        wanted = form(word)
        found = [name for name in known if form(name) == wanted]
        if wanted and found:
            return found
    return []


def near(word: str, names: Collection[str], commands: Collection[str] = ()) -> str | None:
    """What a word is a slip of, if it is one: to be suggested, never to be taken for it.

    Args:
        word: that means nothing.
        names: that may have been meant.
        commands: other words that may have been, if they are nearer than every name, and near enough.
    """
    slip = loosely(word[: 2 * LONGEST_QUOTED])
    lowest = {**dict.fromkeys(commands, LIKENESS_OF_COMMANDS), **dict.fromkeys(names, LIKENESS)}
    likeness = {known: difflib.SequenceMatcher(None, loosely(known), slip).ratio() for known in (*names, *commands)}
    near_enough = [known for known, ratio in likeness.items() if ratio >= lowest[known]]
    return max(near_enough, key=likeness.__getitem__, default=None)


def suggestion(word: str, names: Collection[str], commands: Collection[str] = ()) -> str:
    """What to say of a word that means nothing: `; did you mean snack?`, or nothing; see `near`."""
    name = near(word, names, commands)
    return '' if name is None else f'; did you mean {name}?'


def quoted(word: str) -> str:
    """A word in quotes, in characters that can be seen, and cut if it is long."""
    return repr(word if len(word) <= LONGEST_QUOTED else f'{word[: LONGEST_QUOTED - 1]}…')


def joined(names: Iterable[str], quotes: bool = False) -> str:
    """Names parted by commas; those that hold one are put in quotes, and with `quotes` all are."""
    return ','.join('"{}"'.format(name.replace('"', '""')) if quotes or ',' in name else name for name in names)


def parted(text: str) -> list[str]:
    """The inverse of `joined`, as people write it: blanks beside commas do not count, and neither do empty parts."""
    parts = (within.replace('""', '"') or without.strip() for within, without in _PARTS.findall(text))
    return [part for part in parts if part]


def _trimmed(word: str) -> str:
    return composed(word.strip())
