"""Names that people type or say: which names can be told apart, and which name a typed word means."""

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

COMMAS = ',،、，'
"""Comma characters of ASCII and of other scripts."""
LONGEST_QUOTED = 60
"""Largest number of typed characters that an error message repeats."""
LONGEST_SAID = 1000
"""Largest number of characters of a word that is compared loosely; a longer word must match a name exactly."""
LIKENESS = 0.65
"""Smallest similarity (difflib ratio) of a misspelt word to the name that is meant: one wrong letter of three."""
LIKENESS_OF_COMMANDS = 0.75
"""Smallest similarity of a word to a command: two of four letters swapped.

It is higher than for names, because people rarely mean a command.
"""
_PARTS = re.compile(r'\s*"((?:[^"]|"")+)"\s*(?:,|$)|([^,]+)')


def listed(names: object) -> tuple[str, ...] | None:
    """Return the names as a tuple, or None if the value is not a list of texts; a single text is not a list."""
    if isinstance(names, str) or not isinstance(names, Iterable):
        return None
    found = tuple(names)
    return tuple(map(str, found)) if all(isinstance(name, str) for name in found) else None


def check_names(names: Sequence[str], what: str, has_key: bool = True) -> None:
    """Make sure that people can say each name, and that no word means two of them.

    The text of the error calls one of them by the noun `what`; a name has a key if a single letter can be typed for it.

    Raises:
        InputError: a name is reserved for something else, cannot be typed as it is, or is like another name; the text
            names it and says why.
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
    """Return why people could not use a name, or would mean something else by it; empty if they can use it."""
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
        return 'a text that begins with a brace is read as a JSON document'
    if not holds_word(name):
        return 'it holds no letter'
    if name != composed(name):
        return 'its Unicode is decomposed, letters apart from their accents (NFD): write it composed (NFC)'
    usual = usual_form(name)
    return '' if name == usual else f'it holds full-width or other unusual characters: write {usual!r}'


def _reserved_word(name: str) -> str | None:
    """Return the word of `RESERVED` that a name says or looks like, or None."""
    word = said(name)
    if not word:
        return '?' if set(loosely(name)) & {'?', '¿'} else None
    # A single letter of another alphabet is on another key.
    return _reserved_forms().get(word) or (_reserved_forms().get(in_latin(word)) if len(word) > 1 else None)


@cache
def _reserved_forms() -> Mapping[str, str]:
    """Return the reserved words by their spoken form, with and without accents."""
    forms = {said(word): word for word in RESERVED}
    plain = {without_accents(form): word for form, word in forms.items()}
    return {form: word for form, word in {**plain, **forms}.items() if form}


def meant(word: str, names: Iterable[str]) -> list[str]:
    """Return the names that a word means.

    These are the names that are exactly alike. If there is none, blanks at the ends and the Unicode form are ignored,
    and then also case and width. The list has several names if the word is ambiguous, and none if it matches no name.
    """
    known = list(dict.fromkeys(names))
    for form in (str, str.strip, _trimmed, loosely)[: None if len(word) <= LONGEST_SAID else 1]:
        wanted = form(word)
        found = [name for name in known if form(name) == wanted]
        if wanted and found:
            return found
    return []


def near(word: str, names: Collection[str], commands: Collection[str] = ()) -> str | None:
    """Return the name that a word is probably a misspelling of, or None; it is good for a suggestion only.

    A command is returned only if it is nearer than every name, and near enough.
    """
    slip = loosely(word[: 2 * LONGEST_QUOTED])
    lowest = {**dict.fromkeys(commands, LIKENESS_OF_COMMANDS), **dict.fromkeys(names, LIKENESS)}
    likeness = {known: difflib.SequenceMatcher(None, loosely(known), slip).ratio() for known in (*names, *commands)}
    near_enough = [known for known, ratio in likeness.items() if ratio >= lowest[known]]
    return max(near_enough, key=likeness.__getitem__, default=None)


def suggestion(word: str, names: Collection[str], commands: Collection[str] = ()) -> str:
    """Return a text to add to an error about a word, `; did you mean snack?`, or an empty one; see `near`."""
    name = near(word, names, commands)
    return '' if name is None else f'; did you mean {name}?'


def quoted(word: str) -> str:
    """Return a word in quotes, with invisible characters escaped, and cut if it is long."""
    return repr(word if len(word) <= LONGEST_QUOTED else f'{word[: LONGEST_QUOTED - 1]}…')


def joined(names: Iterable[str], quotes: bool = False) -> str:
    """Join names with commas; a name that holds a comma is put in quotes, and with `quotes` every name is."""
    return ','.join('"{}"'.format(name.replace('"', '""')) if quotes or ',' in name else name for name in names)


def parted(text: str) -> list[str]:
    """Split a text at its commas, as the inverse of `joined`; blanks beside commas and empty parts are ignored."""
    parts = (within.replace('""', '"') or without.strip() for within, without in _PARTS.findall(text))
    return [part for part in parts if part]


def _trimmed(word: str) -> str:
    return composed(word.strip())
