"""Forms of a name: what it shares with others that people take for the same."""

from __future__ import annotations

import re
import unicodedata

QUESTION_MARKS = '？؟՞⸮'
"""Of other scripts and keyboards."""
OTHER_FORMS = ('wide', 'narrow', 'font', 'noBreak', 'circle', 'square', 'initial', 'medial', 'final', 'isolated')
"""Unicode's names for characters that are another form of ordinary ones, and that a keyboard does not give."""
INVISIBLE = re.compile(
    '[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]'
)
"""Characters that are not seen, beside those whose Unicode category says so."""
JOINERS = re.compile('(?<=[\u0590-\U0010ffff])[\u200c\u200d\ufe0e\ufe0f]')
"""What Persian, Sinhala and others write between letters, and what makes pictures of characters."""
POINTS = re.compile(
    '[\u0591-\u05bd\u05bf\u05c1\u05c2\u05c4\u05c5\u05c7\u0610-\u061a\u064b-\u065f\u0670\u06d6-\u06dc\u06df-\u06e8]'
)
"""Vowels and the like, which Hebrew and Arabic may leave out."""
APOSTROPHES = "'’‘ʼʻ´"
SPOKEN_SIGNS = '+#%&@/'
"""What is said, unlike other punctuation."""

_HIRAGANA = ''.join(map(chr, range(0x3041, 0x3097)))
_KATAKANA = ''.join(map(chr, range(0x30A1, 0x30F7)))
_SPELT_ALIKE = str.maketrans(
    'ıё\u0622\u0623\u0625\u0671\u0649\u06cc\u06a9‐‑‒–—−' + APOSTROPHES + _HIRAGANA,
    'iе\u0627\u0627\u0627\u0627\u064a\u064a\u0643------' + "'" * len(APOSTROPHES) + _KATAKANA,
    '\u0640',
)
"""What keyboards and habits differ in: dots of Turkish and Russian, Arabic alef, yeh and kaf, dashes, the two kana."""
_LOOKS_ALIKE = str.maketrans('авекмнорстухіјѕαβεζηικμνορτυχ', 'abekmhopctyxijsabezhikmnoptyx')
"""Cyrillic and Greek letters to the Latin ones that have the same capitals."""


def loosely(name: str) -> str:
    """What names share that people would not tell apart: case, width, form, blanks and underscores do not matter."""
    # What one step leaves behind can be for another one: an accent joins its letter once nothing invisible is between.
    while (folded := _folded(name)) != name:
        name = folded
    return name


def said(name: str) -> str:
    """What is said of a name: its words, loosely, without the punctuation between and around them."""
    words = (character if _is_said(character) else ' ' for character in loosely(name) if character not in APOSTROPHES)
    return ' '.join(''.join(words).split())


def in_latin(text: str) -> str:
    """A loose form with Latin letters for those of other alphabets that look so."""
    return text.translate(_LOOKS_ALIKE)


def without_accents(text: str) -> str:
    """As people write on a keyboard of another language."""
    return composed(re.sub('[\u0300-\u036f]', '', unicodedata.normalize('NFD', text)))


def holds_word(name: str) -> bool:
    """Whether there is a letter in a name, or a picture."""
    return any(
        unicodedata.category(character)[0] == 'L' or (unicodedata.category(character) == 'So' and character > '\u2000')
        for character in loosely(name)
    )


def is_number(name: str) -> bool:
    """Whether a name says a number, or the number of an object as `#7`, `no. 7` or `object 7`."""
    characters = [character for character in name if character.isalnum() or character.isnumeric()]
    if characters and all(map(str.isnumeric, characters)):
        return True
    value = r'\d[\d ]*(e ?\d+)?|0x[\da-f]+|0b[01]+|0o[0-7]+|inf|infinity|nan'
    return re.fullmatch(rf'((object|obj|number|no|nr)? ?#? ?)({value})', said(name)) is not None


def is_invisible(character: str) -> bool:
    """Whether a character cannot be seen, or is a blank other than the usual ones."""
    category = unicodedata.category(character)
    return category in ('Cc', 'Cf', 'Cs', 'Cn', 'Co', 'Zl', 'Zp') or INVISIBLE.match(character) is not None


def usual_form(name: str) -> str:
    """A name as keyboards give it: composed, of ordinary width."""
    unusual = tuple(f'<{form}>' for form in OTHER_FORMS)
    ordinary = (
        unicodedata.normalize('NFKC', character)
        if unicodedata.decomposition(character).startswith(unusual)
        else character
        for character in name
    )
    return composed(''.join(ordinary))


def composed(name: str) -> str:
    """A name in the form of Unicode that keyboards give."""
    return unicodedata.normalize('NFC', name)


def _folded(name: str) -> str:
    text = unicodedata.normalize('NFKC', unicodedata.normalize('NFKC', name.translate(_SPELT_ALIKE)).casefold())
    # The capital I with a dot, small, is an i with a second dot; an acute accent that stands alone is an apostrophe.
    text = POINTS.sub('', text.replace('i\u0307', 'i').replace(' \u0301', "'")).translate(_SPELT_ALIKE)
    text = ''.join(_plain(character) for character in text if not is_invisible(character))
    return ' '.join(text.replace('_', ' ').split())


def _plain(character: str) -> str:
    """A question mark or a digit of any script as that of ASCII."""
    if character in QUESTION_MARKS:
        return '?'
    return str(unicodedata.decimal(character)) if character.isdecimal() else character


def _is_said(character: str) -> bool:
    category = unicodedata.category(character)
    return category[0] in 'LNM' or category in ('So', 'Sc') or character in SPOKEN_SIGNS
