"""The whole screen as lines of text: a function of the view state, the pressed keys, and the terminal."""

from __future__ import annotations

from rich.cells import cell_len
from rich.text import Text

from al_questioner.domain import Query, QueryKind
from al_questioner.questioning.dialogue.answers_in_words import recorded_in_words, said_in_words
from al_questioner.questioning.dialogue.view_state import EpisodeProgress, Phase, Prompt, ViewState
from al_questioner.support.safe_text import counted, printable
from al_questioner.support.text import number_of
from al_questioner.terminal.capabilities import Capabilities
from al_questioner.terminal.keypad import NUMBERED, Pad, letters, numbers_typed
from al_questioner.terminal.sentences import HELP, present_turn, price
from al_questioner.terminal.table_map import position_in_words, table_map
from al_questioner.terminal.thumbnail import cut_out, thumbnail

KEYS = 'n none · u unknown · s skip · z undo · : word · h help · q quit'
GAP = 2
SMALLEST_SCENE = 4
"""Smallest number of rows for a map or a picture."""
MOST_CHOICES = 200
"""Largest number of choices that are shown; no screen has room for more."""
LONGEST_ID = 12
"""Number of digits from which on a number is too long for an object."""
HISTORY = 4
"""Number of rows that are kept for earlier answers, so that map and picture do not move when more come."""


def screen(view_state: ViewState, pad: Pad, capabilities: Capabilities, in_help: bool = False) -> list[Text]:
    """Return the lines of the screen, at most as many as the terminal has rows, none wider than it is."""
    head = [
        *_wrapped(_head(view_state, capabilities), capabilities),
        Text('─' * capabilities.width, style='dim'),
        *_question(view_state, capabilities),
    ]
    if in_help:
        body = [line for paragraph in HELP for line in _wrapped(Text(paragraph), capabilities)]
        return _fitted([*head, Text(), *body, Text(), Text('any key: back', style='dim')], capabilities)
    # A row is reserved for a notice, and a longer notice takes room from the history, so that nothing moves while a
    # question is shown.
    notice = _notice(view_state, pad, capabilities) or [Text()]
    foot = _answers(view_state, pad, capabilities) + notice + _wrapped(Text(KEYS, style='dim'), capabilities)
    room = capabilities.height - len(head) - len(foot) - 1
    table = _table(view_state, pad, capabilities, max(min(room + len(notice) - 1 - HISTORY, room), 0))
    shown = _history(view_state)[: max(0, room - len(table))]
    return _fitted([*head, *table, *foot, *([Text()] if shown else []), *shown], capabilities)


def _head(view_state: ViewState, capabilities: Capabilities) -> Text:
    left = f'Teaching as {printable(view_state.teacher_id, 30)}'
    right = _progress(view_state)
    blanks = capabilities.width - cell_len(left) - cell_len(right)
    return Text.assemble((left, 'bold'), ' ' * blanks if blanks > 1 else ' · ', right)


def _progress(view_state: ViewState) -> str:
    query = None if view_state.prompt is None else view_state.prompt.query
    progress = view_state.progress
    if query is not None:
        of_all = f'of {counted(query.turn + query.turns_left)}'
        if view_state.corrected is not None:
            return f'turn {query.turn} {of_all} · correcting'
        return f'turn {present_turn(query, progress)} {of_all} · {price(query, progress)}'
    if progress is None:
        return ''
    return f'turn {counted(progress.turn)} of {progress.turns} · budget {_left(progress):g} of {progress.budget:g} left'


def _left(progress: EpisodeProgress) -> float:
    return max(0.0, progress.budget - progress.spent)


def _question(view_state: ViewState, capabilities: Capabilities) -> list[Text]:
    if view_state.prompt is None:
        return _wrapped(Text(_meanwhile(view_state), style='italic'), capabilities)
    lines = []
    if view_state.corrected is not None:
        earlier = said_in_words(view_state.prompt.query.action, view_state.corrected.answer)
        lines = _wrapped(Text(f'Correction of: {earlier} (z: leave it so)', style='yellow'), capabilities)
    return lines + _wrapped(Text(printable(view_state.prompt.query.text), style='bold'), capabilities)[:4]


def _meanwhile(view_state: ViewState) -> str:
    if view_state.phase is Phase.OVER:
        return 'The episode is over. z takes your last answer back, q ends.'
    if view_state.phase is Phase.ALONE:
        return 'Waiting for a robot that asks; no learner has been found yet.'
    if view_state.progress is None:
        return 'The robot looks at the table and thinks.'
    left = max(0, view_state.progress.turns - view_state.progress.turn)
    return f'The robot looks at the table and thinks. {number_of(left, "turn")} left.'


def _table(view_state: ViewState, pad: Pad, capabilities: Capabilities, rows: int) -> list[Text]:
    """Return the picture beside the map; the map alone if there is no picture, or little room."""
    prompt = view_state.prompt
    if prompt is None or prompt.scene is None or rows < SMALLEST_SCENE or capabilities.width < 12:
        return []
    focus = _focus(prompt.query, pad)
    if prompt.query.action.kind is QueryKind.LABEL and focus not in prompt.scene.object_ids:
        gone = f'Object {focus} is not in view any more.'
        return [
            *_wrapped(Text(gone, style='yellow'), capabilities),
            *table_map(prompt.scene, capabilities.width, rows - 1, None),
        ]
    # Where a number may be typed, its row is reserved.
    lines = [Text()] if prompt.query.action.kind in NUMBERED else []
    if focus is not None and focus in prompt.scene.object_ids:
        lines = [Text(f'Object {focus}: {position_in_words(prompt.scene, focus)}')]
        lines[0].truncate(capabilities.width)
    rows = min(rows - len(lines), max(SMALLEST_SCENE, capabilities.width // 4))
    picture = _picture(prompt, focus, capabilities, rows)
    taken = max((line.cell_len for line in picture), default=-GAP) + GAP
    if capabilities.width - taken < 24:
        picture, taken = [], 0
    marked = _marked(prompt.query, pad)
    drawn = table_map(prompt.scene, capabilities.width - taken, rows, focus, marked)
    for row, line in enumerate(drawn):
        left = picture[row].copy() if row < len(picture) else Text()
        left.append(' ' * (taken - left.cell_len))
        lines.append(left.append_text(line))
    return lines


def _focus(query: Query, pad: Pad) -> int | None:
    """Return the object that is asked about, or whose number is being typed."""
    if query.action.kind in NUMBERED:
        number = pad.typed.rpartition(',')[2]
        return int(number) if number.isdecimal() and len(number) < LONGEST_ID else None
    return query.action.object_id


def _marked(query: Query, pad: Pad) -> frozenset[int]:
    """Return the objects whose numbers were typed for a list."""
    if query.action.kind is not QueryKind.RELEVANCE:
        return frozenset()
    return frozenset(int(number) for number in numbers_typed(pad) if len(number) < LONGEST_ID)


def _picture(prompt: Prompt, focus: int | None, capabilities: Capabilities, rows: int) -> list[Text]:
    """Return the picture of the object in focus, or of the whole scene without one."""
    if prompt.picture is None or prompt.scene is None:
        return []
    if focus is None:
        return thumbnail(prompt.picture, capabilities.width // 2, rows, capabilities)
    part = cut_out(prompt.picture, prompt.scene, focus)
    return [] if part is None else thumbnail(part, capabilities.width // 3, rows, capabilities)


def _answers(view_state: ViewState, pad: Pad, capabilities: Capabilities) -> list[Text]:
    """Return the possible answers with their keys."""
    if view_state.prompt is None:
        return []
    lines = _choices(view_state.prompt.query, pad, capabilities)
    if view_state.phase is not Phase.SENDING:
        return lines
    sending = _wrapped(Text('… telling the robot', style='italic'), capabilities)
    return [*sending, *(Text() for _ in lines[len(sending) :])]


def _choices(query: Query, pad: Pad, capabilities: Capabilities) -> list[Text]:
    if pad.in_words:
        return _wrapped(Text(f'Your answer in words, then Enter: {printable(pad.typed)}_'), capabilities)
    choices = query.choices[:MOST_CHOICES]
    if query.action.kind is QueryKind.LABEL:
        keys = letters(choices)
        named = [_key(keys.get(symbol, ':'), printable(symbol, capabilities.width - 6)) for symbol in choices]
        return _flowed([*named, _key('n', 'none of these')], capabilities)
    if query.action.kind is QueryKind.DEMONSTRATION:
        return _wrapped(Text(f"An object's number, then Enter; n if none is here: {pad.typed}_"), capabilities)
    if query.action.kind is QueryKind.RELEVANCE:
        how = 'Numbers of the things that matter, with commas between, then Enter; n if nothing here does'
        return _wrapped(Text(f'{how}: {pad.typed}_'), capabilities)
    boxes = [_box(position, group, pad, capabilities) for position, group in enumerate(choices)]
    return [
        *_flowed(boxes, capabilities),
        *_wrapped(Text('Number or space: tick · arrows: move · Enter: that is all'), capabilities),
    ]


def _key(key: str, name: str) -> Text:
    return Text.assemble((f'[{key}]', 'bold'), f' {name}')


def _box(position: int, group: str, pad: Pad, capabilities: Capabilities) -> Text:
    mark = 'x' if position in pad.ticked else ' '
    number = f'{position + 1} ' if position < 9 else ''
    at = '>' if position == pad.cursor else ' '
    style = 'bold reverse' if position == pad.cursor else ''
    return Text.assemble(at, (f'[{mark}] {number}{printable(group, capabilities.width - 10)}', style))


def _notice(view_state: ViewState, pad: Pad, capabilities: Capabilities) -> list[Text]:
    notice = pad.notice or view_state.notice
    return _wrapped(Text(printable(notice, 4 * capabilities.width), style='yellow'), capabilities)[:3] if notice else []


def _history(view_state: ViewState) -> list[Text]:
    """Return the earlier answers, the last first."""
    if view_state.progress is None:
        return []
    return [
        Text(f'turn {record.turn:>3}  {recorded_in_words(record)}', style='dim')
        for record in reversed(view_state.progress.records[-200:])
    ]


def _flowed(pieces: list[Text], capabilities: Capabilities) -> list[Text]:
    """Return lines with pieces side by side, as many to a line as fit."""
    lines = [Text()]
    for piece in pieces:
        if lines[-1].cell_len and lines[-1].cell_len + GAP + piece.cell_len > capabilities.width:
            lines.append(Text())
        lines[-1].append(' ' * GAP if lines[-1].cell_len else '').append_text(piece)
    return lines


def _wrapped(text: Text, capabilities: Capabilities) -> list[Text]:
    return list(text.wrap(capabilities.console(), capabilities.width, overflow='fold'))


def _fitted(lines: list[Text], capabilities: Capabilities) -> list[Text]:
    fitted = lines[: capabilities.height]
    for line in fitted:
        line.truncate(capabilities.width)
    return fitted
