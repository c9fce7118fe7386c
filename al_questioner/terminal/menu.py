"""Menu from which a person at the terminal chooses what the robot asks."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from typing import Protocol, TextIO

import numpy as np

from al_questioner.domain import NO_SYMBOL, Action, EpisodeError, InputError, QueryKind
from al_questioner.domain.names import LONGEST_QUOTED, meant, quoted, suggestion
from al_questioner.domain.reserved_words import FEATURES_WORDS, HELP_WORDS, NOTHING_WORDS
from al_questioner.domain.spelling import loosely
from al_questioner.questioning.candidates import is_open
from al_questioner.questioning.strategies.choice import settled_actions
from al_questioner.questioning.strategies.decision_features import symbol_given_object
from al_questioner.questioning.strategies.human import Picker
from al_questioner.questioning.turn_context import TurnContext

HELP = 'a number asks what that object is, a symbol to be shown one, f which properties matter; Enter asks nothing'
HELP_TABLE = """\
  12       asks what object 12 is
  snack    asks to be shown a snack; the beginning of the symbol is enough
  f        asks which properties matter
  Enter    asks nothing in this turn
  h        shows this"""
RELEVANCE_WORDS = ('r', 'relevance')
HELP_RELEVANCE = '  r        asks which of these things matter'
"""Line of the table where that can be asked."""
MOST_BELIEFS = 2
"""Number of most probable symbols that the menu shows for an object."""


class LineSource(Protocol):
    """Source of lines, such as a file."""

    def readline(self) -> str:
        """Return the next line; empty at the end."""
        ...


class Lines:
    """Lines of a file descriptor, read without the lock of `sys.stdin`.

    A thread that waits for a person holds that lock, and a process that ends in the meantime would be aborted.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._read = b''

    def readline(self) -> str:
        """Return the next line; empty at the end."""
        while b'\n' not in self._read:
            try:
                more = os.read(self._descriptor, 4096)
            except OSError:
                more = b''
            if not more:
                break
            self._read += more
        line, end, self._read = self._read.partition(b'\n')
        return (line + end).decode('utf-8', errors='replace')


def make_picker() -> Picker:
    """Make a function that asks the person at the terminal of this process."""
    lines = Lines(0)
    return lambda context: pick_from_menu(context, lines, sys.stdout)


def pick_from_menu(context: TurnContext, source: LineSource, screen: TextIO) -> int:
    """Show the candidates and read lines until one names a candidate.

    Raises:
        EpisodeError: the input has ended.
    """
    print(menu(context), file=screen)
    while True:
        print('ask> ', end='', file=screen, flush=True)
        line = source.readline()
        if not line:
            raise EpisodeError('strategy human: the input has ended, so nobody chooses; start it in a terminal')
        if _asks_for_help(line, context.symbols):
            print('\n'.join([*([HELP_RELEVANCE] if _has_relevance(context) else []), HELP_TABLE]), file=screen)
            continue
        try:
            return chosen_candidate(line, context)
        except InputError as error:
            print(f'  {error}', file=screen)


def _asks_for_help(line: str, symbols: Sequence[str]) -> bool:
    """Return whether a line is `h`, `help` or `?`, and neither a symbol nor the beginning of one."""
    return bool(meant(line, (*HELP_WORDS, '?'))) and not meant(line, symbols) and not _begun(line, symbols)


def _has_relevance(context: TurnContext) -> bool:
    return context.costs.relevance is not None


def _begun(line: str, symbols: Sequence[str]) -> list[str]:
    """Return the symbols that begin with a line."""
    word = loosely(line)
    return [symbol for symbol in symbols if word and loosely(symbol).startswith(word)]


def chosen_candidate(line: str, context: TurnContext) -> int:
    """Return the index of the candidate that a line names.

    The line is an object's number, a symbol or its beginning, `f`, `r` where that can be asked, or empty for no query.
    A line that is exactly a symbol means that symbol, even if it has another meaning, too.

    Raises:
        InputError: the line names no candidate, or several; the text says what to type.
    """
    word, symbols = line.rstrip('\r\n'), context.symbols
    if not word.strip():
        return _index(Action(QueryKind.NO_QUERY), context, 'asking nothing')
    relevance_words = RELEVANCE_WORDS if _has_relevance(context) else ()
    found = meant(word, (*symbols, *NOTHING_WORDS, NO_SYMBOL, *FEATURES_WORDS, *relevance_words))
    number = loosely(word).removeprefix('#').strip()
    if not found and number.isdecimal():
        return _index_of_object(number, context)
    found = found or _begun(word, symbols)
    if len(found) > 1:
        raise InputError(f'{quoted(word.strip())} could be {" or ".join(found)}: type more of it, or exactly that')
    if not found:
        hint = suggestion(word, symbols, (NOTHING_WORDS[0], FEATURES_WORDS[0], HELP_WORDS[0]))
        raise InputError(f'{quoted(word.strip())} is no question{hint}: {HELP}')
    if found[0] in symbols:
        return _index(Action(QueryKind.DEMONSTRATION, symbol=found[0]), context, f'being shown a {found[0]}')
    if found[0] in FEATURES_WORDS:
        return _index(Action(QueryKind.FEATURE_SUBSET), context, 'that question')
    if found[0] in relevance_words:
        return _index(Action(QueryKind.RELEVANCE), context, 'that question')
    return _index(Action(QueryKind.NO_QUERY), context, 'asking nothing')


def _index_of_object(number: str, context: TurnContext) -> int:
    """Return the index of the question about the object with a number, which may have more digits than any object's."""
    by_number = {str(object_id): object_id for object_id in context.scene.object_ids}
    object_id = by_number.get(number.lstrip('0') or '0')
    what = f'a question about object {number[:LONGEST_QUOTED]}'
    if object_id is None:
        raise InputError(f'{what} is not possible: there is no such object')
    return _index(Action(QueryKind.LABEL, object_id=object_id), context, what)


def menu(context: TurnContext) -> str:
    """Return the candidates by kind with their costs, the beliefs about the objects, and the budget; 80 wide."""
    costs, settled = context.costs, settled_actions(context)
    left = f'budget left: {context.budget_left:g} of {context.budget:g}'
    lines = [f'Turn {context.turn} of {context.turns}; {left}; scene since turn {context.scene_turn}']
    kinds = {action.kind for action in context.candidates}
    if not len(context.scene):
        lines.append('Nothing is in view')
    if QueryKind.LABEL in kinds:
        lines.append(f'What is it? (cost {costs.label:g}; * named already)')
        lines += _columns([_object(context, row, settled) for row in range(len(context.scene))])
    if QueryKind.DEMONSTRATION in kinds:
        lines.append(f'Show me one (cost {costs.demonstration:g}); examples so far:')
        remarks = [_remark(Action(QueryKind.DEMONSTRATION, symbol=symbol), settled) for symbol in context.symbols]
        counts = context.concepts.positives.items()
        lines += _columns([f'{symbol}: {n}{remark}' for (symbol, n), remark in zip(counts, remarks, strict=True)])
    if QueryKind.FEATURE_SUBSET in kinds and Action(QueryKind.FEATURE_SUBSET) not in settled:
        lines.append(f'Which properties matter? (cost {costs.feature_subset:g}): f')
    if QueryKind.RELEVANCE in kinds and Action(QueryKind.RELEVANCE) not in settled:
        lines.append(f'Which of these things matter? (cost {costs.relevance:g}): r')
    lines.append('Nothing: Enter; help: h')
    return '\n'.join(lines)


def _object(context: TurnContext, row: int, settled: set[Action]) -> str:
    object_id = context.scene.object_ids[row]
    p = symbol_given_object(context.probabilities)[row]
    best = np.argsort(-p, kind='stable')[:MOST_BELIEFS]
    beliefs = ', '.join(f'{context.symbols[i]} {p[i]:.0%}' for i in best) if np.ptp(p) else 'anything'
    known = '*' if context.labelled[row] else ' '
    return f'{object_id:>3}{known} {beliefs}' + _remark(Action(QueryKind.LABEL, object_id=object_id), settled)


def _remark(action: Action, settled: set[Action]) -> str:
    return ' (tells nothing new)' if action in settled else ''


def _columns(entries: Sequence[str], width: int = 80) -> list[str]:
    """Return the lines with the entries in as many columns as fit."""
    column = max(len(entry) for entry in entries) + 2
    per_line = max(1, (width - 2) // column)
    return [
        ('  ' + ''.join(entry.ljust(column) for entry in entries[first : first + per_line])).rstrip()
        for first in range(0, len(entries), per_line)
    ]


def _index(action: Action, context: TurnContext, what: str) -> int:
    reason = _reason_against(action, context)
    if reason:
        raise InputError(f'{what} is not possible: {reason}')
    return context.candidates.index(action)


def _reason_against(action: Action, context: TurnContext) -> str:
    """Return why an action cannot be chosen; empty if it can."""
    if action.kind is QueryKind.LABEL and action.object_id not in context.scene.object_ids:
        return 'there is no such object'
    if not is_open(action.kind, context.scene):
        return 'nothing is in view' if not len(context.scene) else 'it has only one possible answer'
    if action.symbol in context.excluded_symbols:
        return 'all things here have been named otherwise'
    if action in context.known_answers:
        return 'its only possible answer is known'
    if action in settled_actions(context):
        return 'it was asked before and would tell nothing new'
    return '' if action in context.candidates else 'the budget does not pay for it'
