"""Names that people say: which can be told apart, and which is meant by what somebody typed."""

from __future__ import annotations

import difflib
import re
import unicodedata
from collections.abc import Collection, Iterable, Mapping, Sequence
from types import MappingProxyType

from al_questioner.domain.errors import InputError
from al_questioner.domain.query import NO_SYMBOL

UNKNOWN_WORDS = ('?', 'unknown')
SKIP_WORDS = ('skip',)
NOTHING_WORDS = ('nothing', 'n')
FEATURES_WORDS = ('features', 'feature', 'f')
HELP_WORDS = ('help', 'h')

OTHER_LANGUAGES = MappingProxyType(
    {
        NO_SYMBOL: (
            *('keine', 'keins', 'keines', 'keiner', 'nichts', 'aucun', 'aucune', 'rien', 'ninguno', 'ninguna', 'nada'),
            *(
                'nessuno',
                'nessuna',
                'niente',
                'kein',
                'nein',
                'nadie',
                'ninguém',
                'nenhum',
                'nenhuma',
                'geen',
                'niets',
                'ingen',
                'inget',
                'intet',
                'żaden',
            ),
            *('nic', 'žádný', 'ничего', 'なし', '没有', '沒有', '없음', 'لا شيء'),
        ),
        'unknown': (
            *('unbekannt', 'inconnu', 'inconnue', 'desconocido', 'desconocida', 'sconosciuto', 'sconosciuta'),
            *('desconhecido', 'desconhecida', 'onbekend', 'okänd', 'ukendt', 'nieznany', 'neznámý', 'неизвестно'),
            *('不明', '未知', '모름', 'مجهول', 'weiß nicht', 'keine ahnung', 'no sé', 'je ne sais pas'),
            *('non so', 'não sei', 'weet ik niet', 'не знаю', '不知道', 'わからない', '모르겠어요'),
        ),
        'skip': (
            *('überspringen', 'passer', 'omitir', 'saltar', 'salta', 'pular', 'overslaan', 'hoppa', 'pomiń'),
            *('přeskočit', 'пропустить', 'スキップ', '跳过', '跳過', '건너뛰기', 'تخطي', 'sauter', 'ignorer'),
            *('auslassen', 'weiter'),
        ),
    }
)
"""Words of other languages for ours: a teacher who says them means that, and no symbol."""

RESERVED: Mapping[str, str] = MappingProxyType(
    {
        NO_SYMBOL: 'says that a thing belongs to no symbol',
        **dict.fromkeys(UNKNOWN_WORDS, 'says that the teacher does not know'),
        **dict.fromkeys(SKIP_WORDS, 'skips a question'),
        **dict.fromkeys(NOTHING_WORDS, 'stands for nothing'),
        **dict.fromkeys(FEATURES_WORDS, 'asks which properties matter'),
        **dict.fromkeys(HELP_WORDS, 'asks for help'),
        'u': 'is the key of "I do not know"',
        's': 'is the key of "skip"',
        'undo': 'takes an answer back',
        'z': 'takes an answer back',
        **dict.fromkeys(('idk', "don't know", 'i do not know', "i don't know"), 'says that the teacher does not know'),
        **dict.fromkeys(('none of these', 'none of them', 'no symbol'), 'says that a thing belongs to no symbol'),
        **dict.fromkeys(('pass', 'cancel', 'stop', 'back', 'exit'), 'is what people say to a program'),
        'quit': 'ends the conversation',
        'q': 'ends the conversation',
        **{word: f'means {ours!r}' for ours, words in OTHER_LANGUAGES.items() for word in words},
    }
)
"""What people type that is no name, in any of our programs, and what it means."""
KEYS = frozenset(word for word in RESERVED if len(word) == 1 and word.isalpha())
"""Those that are a single letter: they mean nothing where names are said in other ways."""

COMMAS = ',،、'
"""Of ASCII and of other scripts."""
QUESTION_MARKS = '？؟՞⸮'
"""Of other scripts and keyboards."""
OTHER_FORMS = ('wide', 'narrow', 'font', 'noBreak', 'circle', 'square', 'initial', 'medial', 'final', 'isolated')
"""Unicode's names for characters that are another form of ordinary ones, and that a keyboard does not give."""
INVISIBLE = re.compile(
    '[\u034f\u115f\u1160\u17b4\u17b5\u180b-\u180f\u2800\u3164\ufe00-\ufe0f\uffa0\U000e0100-\U000e01ef]'
)
"""Characters that are not seen, beside those whose Unicode category says so."""
LONGEST_QUOTED = 60
"""Characters of what somebody typed that an explanation repeats."""
LONGEST_SAID = 1000
"""Characters; what is longer is a name only if it is one exactly."""
LIKENESS = 0.65
"""From which on a word is near another, by the measure of difflib: one wrong letter of three."""
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
        other = seen.setdefault(loosely(name), name)
        if other is not name:
            raise InputError(f'{quoted(name)} cannot be a {what} beside {quoted(other)}: said, they are the same')


def unsayable(name: str, has_key: bool = True) -> str:
    """Why people could not say a name, or would say something else by it; empty if they can."""
    unseen = next(filter(is_invisible, name), None)
    if unseen is not None:
        return f'it holds the invisible character U+{ord(unseen):04X}'
    if not name.strip():
        return 'it is empty'
    if name != name.strip():
        return 'it begins or ends with a blank'
    loose = loosely(name)
    bare = loose.strip('.!,;: ') or loose
    if bare in RESERVED and (has_key or bare not in KEYS):
        return f'to the robot {bare!r} {RESERVED[bare]}'
    if is_number(loose):
        return 'a number means an object'
    if '"' in loose:
        return 'quotes mark where a name begins and ends'
    if any(comma in loose for comma in COMMAS):
        return 'a comma parts names'
    if loose.startswith('{'):
        return 'what begins with a brace is read as a JSON document'
    if name != composed(name):
        return 'its Unicode is decomposed, letters apart from their accents (NFD): write it composed (NFC)'
    usual = usual_form(name)
    return '' if name == usual else f'it holds full-width or other unusual characters: write {usual!r}'


def loosely(name: str) -> str:
    """What names share that people would not tell apart: case, width, form, blanks and underscores do not matter."""
    # What one step leaves behind can be for another one: an accent joins its letter once nothing invisible is between.
    while (folded := _folded(name)) != name:
        name = folded
    return name


def _folded(name: str) -> str:
    text = unicodedata.normalize('NFKC', unicodedata.normalize('NFKC', name).casefold())
    # The capital I with a dot, small, is an i with a second dot.
    text = text.replace('i\u0307', 'i')
    text = ''.join(_plain(character) for character in text if not is_invisible(character))
    return ' '.join(text.replace('_', ' ').split())


def is_invisible(character: str) -> bool:
    """Whether a character cannot be seen, or is a blank other than the usual ones."""
    category = unicodedata.category(character)
    return category in ('Cc', 'Cf', 'Cs', 'Cn', 'Co', 'Zl', 'Zp') or INVISIBLE.match(character) is not None


def is_number(loose: str) -> bool:
    """Whether a word says a number, or the number of an object as `#7` or `object 7`."""
    word = re.sub(r'^(object|#)\s*#?\s*', '', loose)
    return word.isnumeric() or re.fullmatch(r'[-+]?(?=\D?\d)[\d. \u2044]+(e[-+]?\d+)?', word) is not None


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


def near(word: str, names: Collection[str]) -> str | None:
    """The name that a word is a slip of, if there is one: to be suggested, never to be taken for it."""
    by_key = {loosely(name): name for name in names}
    found = difflib.get_close_matches(loosely(word[: 2 * LONGEST_QUOTED]), by_key, 1, LIKENESS)
    return by_key[found[0]] if found else None


def suggestion(word: str, names: Collection[str]) -> str:
    """What to say of a word that means nothing: `; did you mean snack?`, or nothing."""
    name = near(word, names)
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


def _plain(character: str) -> str:
    """A question mark or a digit of any script as that of ASCII."""
    if character in QUESTION_MARKS:
        return '?'
    return str(unicodedata.decimal(character)) if character.isdecimal() else character
