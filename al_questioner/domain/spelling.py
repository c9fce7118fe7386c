"""Normal forms of names, in which names that people take for the same are equal."""

from __future__ import annotations

import re
import unicodedata

QUESTION_MARKS = '？؟՞⸮'
"""Question marks of other scripts and keyboards."""
OTHER_FORMS = ('wide', 'narrow', 'font', 'noBreak', 'circle', 'square', 'initial', 'medial', 'final', 'isolated')
"""Unicode's terms for characters that are another form of an ordinary one and that a keyboard does not produce."""
INVISIBLE = re.compile(
    '[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]'
)
"""Characters that cannot be seen, in addition to those whose Unicode category says so."""
JOINERS = re.compile('(?<=[\u0590-\U0010ffff])[\u200c\u200d\ufe0e\ufe0f]')
"""Invisible characters that Persian, Sinhala and others write between letters, and that make characters pictures."""
POINTS = re.compile(
    '[\u0591-\u05bd\u05bf\u05c1\u05c2\u05c4\u05c5\u05c7\u0610-\u061a\u064b-\u065f\u0670\u06d6-\u06dc\u06df-\u06e8]'
)
"""Vowel marks and similar signs that Hebrew and Arabic may leave out."""
APOSTROPHES = "'’‘ʼʻ´"
SPOKEN_SIGNS = '+#%&@/'
"""Signs that people say aloud, unlike other punctuation."""

_HIRAGANA = ''.join(map(chr, range(0x3041, 0x3097)))
_KATAKANA = ''.join(map(chr, range(0x30A1, 0x30F7)))
_SPELT_ALIKE = str.maketrans(
    'ıё\u0622\u0623\u0625\u0671\u0649\u06cc\u06a9‐‑‒–—−' + APOSTROPHES + _HIRAGANA,
    'iе\u0627\u0627\u0627\u0627\u064a\u064a\u0643------' + "'" * len(APOSTROPHES) + _KATAKANA,
    '\u0640',
)
"""Characters that differ by keyboard and habit, mapped to one of them.

They are the dots of Turkish and Russian letters, Arabic alef, yeh and kaf, dashes, and the two kana.
"""
_LOOKS_ALIKE = str.maketrans('авекмнорстухіјѕαβεζηικμνορτυχ', 'abekmhopctyxijsabezhikmnoptyx')
"""Cyrillic and Greek letters mapped to the Latin letters that have the same capitals."""


def loosely(name: str) -> str:
    """Return the form of a name that ignores case, width, letter forms, blanks and underscores."""
    # Fold until nothing changes: an accent joins its letter only after the invisible character between them is gone.
    while (folded := _folded(name)) != name:
        name = folded
    return name


def said(name: str) -> str:
    """Return the spoken form of a name: its words as in `loosely`, without the punctuation between and around them."""
    words = (character if _is_said(character) else ' ' for character in loosely(name) if character not in APOSTROPHES)
    return ' '.join(''.join(words).split())


def in_latin(text: str) -> str:
    """Return a loose form in which letters of other alphabets that look Latin are Latin."""
    return text.translate(_LOOKS_ALIKE)


def without_accents(text: str) -> str:
    """Return a text without its accents, as people type it on a keyboard of another language."""
    return composed(re.sub('[\u0300-\u036f]', '', unicodedata.normalize('NFD', text)))


def holds_word(name: str) -> bool:
    """Return whether a name has a letter, or a character that is a picture."""
    found = ((unicodedata.category(character), character) for character in loosely(name))
    return any(category[0] == 'L' or (category == 'So' and character > '\u2000') for category, character in found)


def is_number(name: str) -> bool:
    """Return whether a name is a number, or the number of an object as `#7`, `no. 7` or `object 7`."""
    characters = [character for character in name if character.isalnum() or character.isnumeric()]
    if characters and all(map(str.isnumeric, characters)):
        return True
    value = r'\d[\d ]*(e ?\d+)?|0x[\da-f]+|0b[01]+|0o[0-7]+|inf|infinity|nan'
    return re.fullmatch(rf'((object|obj|number|no|nr)? ?#? ?)({value})', said(name)) is not None


def is_invisible(character: str) -> bool:
    """Return whether a character cannot be seen, or is an unusual blank."""
    category = unicodedata.category(character)
    return category in ('Cc', 'Cf', 'Cs', 'Cn', 'Co', 'Zl', 'Zp') or INVISIBLE.match(character) is not None


def usual_form(name: str) -> str:
    """Return a name as keyboards produce it: composed, of ordinary width."""
    unusual = tuple(f'<{form}>' for form in OTHER_FORMS)
    ordinary = (
        unicodedata.normalize('NFKC', character)
        if unicodedata.decomposition(character).startswith(unusual)
        else character
        for character in name
    )
    return composed(''.join(ordinary))


def composed(name: str) -> str:
    """Return a name in the Unicode form that keyboards produce (NFC)."""
    return unicodedata.normalize('NFC', name)


def _folded(name: str) -> str:
    text = unicodedata.normalize('NFKC', unicodedata.normalize('NFKC', name.translate(_SPELT_ALIKE)).casefold())
    # Lowercase of the capital I with a dot is an i with a second dot. An acute accent alone is an apostrophe.
    text = POINTS.sub('', text.replace('i\u0307', 'i').replace(' \u0301', "'")).translate(_SPELT_ALIKE)
    text = ''.join(_plain(character) for character in text if not is_invisible(character))
    return ' '.join(text.replace('_', ' ').split())


def _plain(character: str) -> str:
    """Return a question mark or a digit of any script as the ASCII one."""
    if character in QUESTION_MARKS:
        return '?'
    return str(unicodedata.decimal(character)) if character.isdecimal() else character


def _is_said(character: str) -> bool:
    category = unicodedata.category(character)
    return category[0] in 'LNM' or category in ('So', 'Sc') or character in SPOKEN_SIGNS
