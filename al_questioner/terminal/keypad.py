"""Meaning of keys at a question: a letter for each symbol, digits for objects, ticks for feature groups."""

from __future__ import annotations

import string
from collections.abc import Sequence
from dataclasses import dataclass, replace

from al_questioner.domain import NO_SYMBOL, Query, QueryKind
from al_questioner.domain.names import joined
from al_questioner.domain.spelling import loosely
from al_questioner.questioning.dialogue.view_state import Phase, ViewState
from al_questioner.support.safe_text import printable
from al_questioner.terminal.commands import Command, Explain, Say, Wish, read_line

COMMANDS: dict[str, Command] = {
    'n': Say(NO_SYMBOL),
    '?': Say('?'),
    'u': Say('?'),
    's': Say('skip'),
    'z': Wish.UNDO,
    'h': Wish.HELP,
    'q': Wish.QUIT,
}
"""Keys that mean the same at every question and are never the key of a symbol."""
LONGEST = 80
"""Largest number of characters that can be typed."""
LONGEST_LIST = 1000
"""Largest number of characters of a list of objects."""
NUMBERED = (QueryKind.DEMONSTRATION, QueryKind.RELEVANCE)
"""Kinds of queries that are answered by numbers of objects."""


@dataclass(frozen=True)
class Pad:
    """Keys that were pressed so far at a question.

    Attributes:
        about: the question at which they were pressed.
        typed: numbers of objects, or a word.
        in_words: whether a word is typed, after a colon.
        ticked: positions of feature groups.
        cursor: position of the group that space ticks.
        doubted: the last key, if it must be pressed again to count.
        notice: why the last key did nothing.
    """

    about: str = ''
    typed: str = ''
    in_words: bool = False
    ticked: frozenset[int] = frozenset()
    cursor: int = 0
    doubted: str = ''
    notice: str = ''

    def explained(self, notice: str) -> Pad:
        """Return the same pad with an explanation."""
        return replace(self, notice=notice)


def about(view_state: ViewState) -> str:
    """Return a text that identifies the question that is shown; empty if none can be answered."""
    if view_state.prompt is None or view_state.phase not in (Phase.ASKED, Phase.CORRECTING):
        return ''
    return f'{view_state.phase.name}/{view_state.prompt.query.query_id}'


def choices_of(view_state: ViewState) -> tuple[str, ...]:
    """Return the choices of the question that can be answered; none if there is none."""
    return view_state.prompt.query.choices if view_state.prompt is not None and about(view_state) else ()


def letters(symbols: Sequence[str]) -> dict[str, str]:
    """Return the key of each symbol: the first letter of its name, else another free letter of it or any free key.

    First letters are assigned first, so that as far as possible each key is the first letter of its name. A symbol
    after the last free key has none, and is typed after a colon.
    """
    free = [
        key for key in string.ascii_lowercase + string.digits + string.ascii_uppercase if key.lower() not in COMMANDS
    ]
    keys: dict[str, str] = {}
    for symbol in symbols:
        first = loosely(symbol)[:1]
        if first in free:
            keys[symbol] = first
            free.remove(first)
    for symbol in symbols:
        if symbol not in keys and free:
            keys[symbol] = next((letter for letter in loosely(symbol) if letter in free), free[0])
            free.remove(keys[symbol])
    return keys


def press(key: str, pad: Pad, view_state: ViewState) -> tuple[Pad, Command | None]:
    """Return the effect of a key.

    Args:
        key: a character, or 'enter', 'backspace', 'escape', 'up', 'down', 'left', 'right', 'tab'.
        pad: the keys before.
        view_state: the present view state.

    Returns:
        The keys so far, and a command, if there is one.
    """
    here, doubted = about(view_state), pad.doubted
    pad = replace(pad, notice='', doubted='') if pad.about == here else Pad(here)
    if view_state.prompt is None or not here:
        command = COMMANDS.get(key.lower())
        return pad, command if isinstance(command, Wish) else None
    query = view_state.prompt.query
    if pad.in_words or (key == ':' and not pad.typed):
        return _typed_word(key, pad, query)
    if key == 'escape':
        return (Pad(here), None) if pad != Pad(here) else (pad, Wish.UNDO if view_state.corrected is not None else None)
    if key == 'backspace' and not pad.typed:
        return pad, Wish.UNDO
    if key.lower() in COMMANDS and not pad.typed:
        return _command(key, pad, query, doubted)
    if query.action.kind is QueryKind.LABEL:
        return _at_label(key, pad, query)
    if query.action.kind is QueryKind.DEMONSTRATION:
        return _at_demonstration(key, pad)
    if query.action.kind is QueryKind.RELEVANCE:
        return _at_relevance(key, pad)
    return _at_feature_subset(key, pad, query)


def _typed_word(key: str, pad: Pad, query: Query) -> tuple[Pad, Command | None]:
    if not pad.in_words:
        return replace(pad, in_words=True), None
    if key == 'enter':
        return Pad(pad.about), read_line(pad.typed, query.choices)
    if key == 'escape' or (key == 'backspace' and not pad.typed):
        return Pad(pad.about), None
    if key == 'backspace':
        return replace(pad, typed=pad.typed[:-1]), None
    return _append(key, pad), None


def _command(key: str, pad: Pad, query: Query, doubted: str) -> tuple[Pad, Command | None]:
    """Return the effect of a command key; if a choice begins with the same letter, it must be pressed twice."""
    command = COMMANDS[key.lower()]
    # If the answer is a number, no letter can be meant as the first one of a choice.
    choices = () if query.action.kind in NUMBERED else query.choices
    alike = next((choice for choice in choices if loosely(choice).startswith(key.lower())), None)
    if alike is None or command is Wish.HELP or doubted == key.lower():
        return pad, command
    # A person who presses the first letter of a name means that name, and would give another answer by mistake.
    explained = f'{_named(key)} means {_meaning(command)} here: press it again for that; {_way_to_say(alike, query)}'
    return replace(pad, doubted=key.lower()), Explain(explained)


def _at_label(key: str, pad: Pad, query: Query) -> tuple[Pad, Command | None]:
    symbols = {letter: symbol for symbol, letter in letters(query.choices).items()}
    if key in symbols:
        return pad, Say(symbols[key])
    # A name may begin with a capital: both cases mean a letter, unless there are so many names that one is another's.
    symbol = symbols.get(key.lower())
    if symbol is None:
        return pad, Explain(f'{_named(key)} is the key of no answer; h explains')
    capitals = [other for other in query.choices if other.startswith(key)]
    if not capitals or symbol in capitals:
        return pad, Say(symbol)
    ways = f'{_way_to_say(symbol, query)}, {_way_to_say(capitals[0], query)}'
    return pad, Explain(f'{_named(key)} could mean two things: {ways}')


def _way_to_say(choice: str, query: Query) -> str:
    """Return how to choose an answer by key."""
    if query.action.kind is QueryKind.FEATURE_SUBSET:
        position = query.choices.index(choice) + 1
        return f'for {choice} ' + (f'press {position}' if position <= 9 else 'use arrows and space')
    key = letters(query.choices).get(choice)
    return f'for {choice} ' + (f'press {key}' if key else 'type it after a colon')


def _meaning(command: Command) -> str:
    if isinstance(command, Wish):
        return command.value
    return {'?': 'unknown'}.get(command.text, command.text)


def _at_demonstration(key: str, pad: Pad) -> tuple[Pad, Command | None]:
    if key == 'enter':
        if not pad.typed:
            return pad, Explain("type an object's number before Enter, or n for none")
        return Pad(pad.about), Say(pad.typed)
    if key == 'backspace':
        return replace(pad, typed=pad.typed[:-1]), None
    if len(key) == 1 and key in string.digits:
        return _append(key, pad), None
    return pad, Explain(f"{_named(key)} is no digit; type an object's number and Enter; h explains")


def _at_relevance(key: str, pad: Pad) -> tuple[Pad, Command | None]:
    if key == 'enter':
        if not numbers_typed(pad):
            return pad, Explain('type the numbers of the things that matter before Enter, or n if nothing here does')
        return Pad(pad.about), Say(','.join(numbers_typed(pad)))
    if key == 'backspace':
        return replace(pad, typed=pad.typed[:-1]), None
    if key == ' ':
        key = ','
    if len(key) == 1 and key in string.digits + ',':
        # A comma parts two numbers, and nothing else.
        parts_nothing = key == ',' and (not pad.typed or pad.typed.endswith(','))
        return (pad if parts_nothing else _append(key, pad, LONGEST_LIST)), None
    return pad, Explain(f'{_named(key)} is no digit; type numbers with commas between, and Enter; h explains')


def numbers_typed(pad: Pad) -> tuple[str, ...]:
    """Return the numbers that were typed so far, the last one perhaps in part."""
    return tuple(number for number in pad.typed.split(',') if number.isdecimal())


def _at_feature_subset(key: str, pad: Pad, query: Query) -> tuple[Pad, Command | None]:
    count = len(query.choices)
    if key == 'enter':
        if not pad.ticked:
            return pad, Explain('tick what matters with space before Enter, or press u if you do not know')
        # If one name has a comma, names without quotes could be read as parts of it.
        quotes = any(',' in choice for choice in query.choices)
        return Pad(pad.about), Say(joined((query.choices[position] for position in sorted(pad.ticked)), quotes))
    steps = {'right': 1, 'down': 1, 'tab': 1, 'left': -1, 'up': -1}
    if key in steps and count:
        return replace(pad, cursor=(pad.cursor + steps[key]) % count), None
    position = pad.cursor if key == ' ' else string.digits.find(key) - 1 if len(key) == 1 else -1
    if 0 <= position < count:
        return replace(pad, ticked=pad.ticked ^ {position}, cursor=position), None
    return pad, Explain(f'{_named(key)} ticks nothing; use numbers, or arrows and space; h explains')


def _append(key: str, pad: Pad, longest: int = LONGEST) -> Pad:
    """Return the pad with one more character, if it can be shown and there is room."""
    fits = len(key) == 1 and key.isprintable() and len(pad.typed) < longest
    return replace(pad, typed=pad.typed + key) if fits else pad


def _named(key: str) -> str:
    return f'"{printable(key, 20)}"'
