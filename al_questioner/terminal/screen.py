"""The whole screen as lines of text: a function of what there is to show, what was pressed, and the terminal."""

from __future__ import annotations

from rich.cells import cell_len
from rich.text import Text

from al_questioner.domain import Query, QueryKind
from al_questioner.support.text import number_of
from al_questioner.terminal.board import Board, Moment, Phase, Progress
from al_questioner.terminal.keypad import Pad, letters
from al_questioner.terminal.look import Look
from al_questioner.terminal.safe_text import counted, printable
from al_questioner.terminal.sentences import HELP, present_turn, price, recorded_in_words, said_in_words
from al_questioner.terminal.table_map import position_in_words, table_map
from al_questioner.terminal.thumbnail import cut_out, thumbnail

KEYS = 'n none · u unknown · s skip · z undo · : word · h help · q quit'
GAP = 2
SMALLEST_SCENE = 4
"""Rows below which neither map nor picture is worth showing."""
MOST_CHOICES = 200
"""That are shown; no screen has room for more."""
HISTORY = 4
"""Rows that map and picture leave to earlier answers, so that they stay where they are as there come more."""


def screen(board: Board, pad: Pad, look: Look, in_help: bool = False) -> list[Text]:
    """At most as many lines as the terminal has rows, none wider than it is.

    Args:
        board: what there is to show.
        pad: what was pressed at the question that is shown.
        look: the terminal.
        in_help: show the help in the place of the table.
    """
    head = [*_wrapped(_head(board, look), look), Text('─' * look.width, style='dim'), *_question(board, look)]
    if in_help:
        body = [line for paragraph in HELP for line in _wrapped(Text(paragraph), look)]
        return _fitted([*head, Text(), *body, Text(), Text('any key: back', style='dim')], look)
    # A row for what there is to say is left free, and longer words take the room of the history: as long as a
    # question is shown, nothing that may be looked at moves.
    notice = _notice(board, pad, look) or [Text()]
    foot = _answers(board, pad, look) + notice + _wrapped(Text(KEYS, style='dim'), look)
    room = look.height - len(head) - len(foot) - 1
    table = _table(board, pad, look, max(min(room + len(notice) - 1 - HISTORY, room), 0))
    shown = _history(board)[: max(0, room - len(table))]
    return _fitted([*head, *table, *foot, *([Text()] if shown else []), *shown], look)


def _head(board: Board, look: Look) -> Text:
    left = f'Teaching as {printable(board.teacher_id, 30)}'
    right = _progress(board)
    blanks = look.width - cell_len(left) - cell_len(right)
    return Text.assemble((left, 'bold'), ' ' * blanks if blanks > 1 else ' · ', right)


def _progress(board: Board) -> str:
    query = None if board.moment is None else board.moment.query
    progress = board.progress
    if query is not None:
        of_all = f'of {counted(query.turn + query.turns_left)}'
        if board.corrected is not None:
            return f'turn {query.turn} {of_all} · correcting'
        return f'turn {present_turn(query, progress)} {of_all} · {price(query, progress)}'
    if progress is None:
        return ''
    return f'turn {counted(progress.turn)} of {progress.turns} · budget {_left(progress):g} of {progress.budget:g} left'


def _left(progress: Progress) -> float:
    return max(0.0, progress.budget - progress.spent)


def _question(board: Board, look: Look) -> list[Text]:
    if board.moment is None:
        return _wrapped(Text(_meanwhile(board), style='italic'), look)
    lines = []
    if board.corrected is not None:
        earlier = said_in_words(board.moment.query.action, board.corrected.answer)
        lines = _wrapped(Text(f'Correction of: {earlier} (z: leave it so)', style='yellow'), look)
    return lines + _wrapped(Text(printable(board.moment.query.text), style='bold'), look)[:4]


def _meanwhile(board: Board) -> str:
    if board.phase is Phase.OVER:
        return 'The episode is over. z takes your last answer back, q ends.'
    if board.phase is Phase.ALONE:
        return 'Waiting for a robot that asks; no learner has been heard yet.'
    if board.progress is None:
        return 'The robot looks at the table and thinks.'
    left = max(0, board.progress.turns - board.progress.turn)
    return f'The robot looks at the table and thinks. {number_of(left, "turn")} left.'


def _table(board: Board, pad: Pad, look: Look, rows: int) -> list[Text]:
    """The picture beside the map; the map alone where there is no picture, or little room."""
    moment = board.moment
    if moment is None or moment.scene is None or rows < SMALLEST_SCENE or look.width < 12:
        return []
    focus = _focus(moment.query, pad)
    if moment.query.action.kind is QueryKind.LABEL and focus not in moment.scene.object_ids:
        gone = f'Object {focus} is not in view any more.'
        return [*_wrapped(Text(gone, style='yellow'), look), *table_map(moment.scene, look.width, rows - 1, None)]
    # Where a number may be typed, the row is there before it is.
    lines = [Text()] if moment.query.action.kind is QueryKind.DEMONSTRATION else []
    if focus is not None and focus in moment.scene.object_ids:
        lines = [Text(f'Object {focus}: {position_in_words(moment.scene, focus)}')]
        lines[0].truncate(look.width)
    rows = min(rows - len(lines), max(SMALLEST_SCENE, look.width // 4))
    picture = _picture(moment, focus, look, rows)
    taken = max((line.cell_len for line in picture), default=-GAP) + GAP
    if look.width - taken < 24:
        picture, taken = [], 0
    drawn = table_map(moment.scene, look.width - taken, rows, focus)
    for row, line in enumerate(drawn):
        left = picture[row].copy() if row < len(picture) else Text()
        left.append(' ' * (taken - left.cell_len))
        lines.append(left.append_text(line))
    return lines


def _focus(query: Query, pad: Pad) -> int | None:
    """The object that is asked about, or whose number is being typed."""
    if query.action.kind is QueryKind.DEMONSTRATION:
        return int(pad.typed) if pad.typed.isdecimal() and len(pad.typed) < 12 else None
    return query.action.object_id


def _picture(moment: Moment, focus: int | None, look: Look, rows: int) -> list[Text]:
    """Of the object in focus; of the whole scene where there is none."""
    if moment.picture is None or moment.scene is None:
        return []
    if focus is None:
        return thumbnail(moment.picture, look.width // 2, rows, look)
    part = cut_out(moment.picture, moment.scene, focus)
    return [] if part is None else thumbnail(part, look.width // 3, rows, look)


def _answers(board: Board, pad: Pad, look: Look) -> list[Text]:
    """What can be answered, with its keys."""
    if board.moment is None:
        return []
    lines = _choices(board.moment.query, pad, look)
    if board.phase is not Phase.SENDING:
        return lines
    sending = _wrapped(Text('… telling the robot', style='italic'), look)
    return [*sending, *(Text() for _ in lines[len(sending) :])]


def _choices(query: Query, pad: Pad, look: Look) -> list[Text]:
    if pad.in_words:
        return _wrapped(Text(f'Your answer in words, then Enter: {printable(pad.typed)}_'), look)
    choices = query.choices[:MOST_CHOICES]
    if query.action.kind is QueryKind.LABEL:
        keys = letters(choices)
        named = [_key(keys.get(symbol, ':'), printable(symbol, look.width - 6)) for symbol in choices]
        return _flowed([*named, _key('n', 'none of these')], look)
    if query.action.kind is QueryKind.DEMONSTRATION:
        return _wrapped(Text(f"An object's number, then Enter; n if none is here: {pad.typed}_"), look)
    boxes = [_box(position, group, pad, look) for position, group in enumerate(choices)]
    return [*_flowed(boxes, look), *_wrapped(Text('Number or space: tick · arrows: move · Enter: that is all'), look)]


def _key(key: str, name: str) -> Text:
    return Text.assemble((f'[{key}]', 'bold'), f' {name}')


def _box(position: int, group: str, pad: Pad, look: Look) -> Text:
    mark = 'x' if position in pad.ticked else ' '
    number = f'{position + 1} ' if position < 9 else ''
    at = '>' if position == pad.cursor else ' '
    style = 'bold reverse' if position == pad.cursor else ''
    return Text.assemble(at, (f'[{mark}] {number}{printable(group, look.width - 10)}', style))


def _notice(board: Board, pad: Pad, look: Look) -> list[Text]:
    notice = pad.notice or board.notice
    return _wrapped(Text(printable(notice, 4 * look.width), style='yellow'), look)[:3] if notice else []


def _history(board: Board) -> list[Text]:
    """What was answered before, the last first."""
    if board.progress is None:
        return []
    return [
        Text(f'turn {record.turn:>3}  {recorded_in_words(record)}', style='dim')
        for record in reversed(board.progress.records[-200:])
    ]


def _flowed(pieces: list[Text], look: Look) -> list[Text]:
    """Pieces side by side, as many to a line as fit."""
    lines = [Text()]
    for piece in pieces:
        if lines[-1].cell_len and lines[-1].cell_len + GAP + piece.cell_len > look.width:
            lines.append(Text())
        lines[-1].append(' ' * GAP if lines[-1].cell_len else '').append_text(piece)
    return lines


def _wrapped(text: Text, look: Look) -> list[Text]:
    return list(text.wrap(look.console(), look.width, overflow='fold'))


def _fitted(lines: list[Text], look: Look) -> list[Text]:
    fitted = lines[: look.height]
    for line in fitted:
        line.truncate(look.width)
    return fitted
