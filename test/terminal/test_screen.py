"""The screen, on any terminal."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rich.cells import cell_len

from al_questioner.domain import Answer, Outcome, QueryKind, QueryRecord
from al_questioner.questioning.dialogue.answers_in_words import recorded_in_words, said_in_words
from al_questioner.terminal.capabilities import Capabilities
from al_questioner.terminal.keypad import Pad, about, press
from al_questioner.terminal.screen import screen
from al_questioner.terminal.sentences import farewell, question_line

SIZES = ((80, 24), (40, 24), (80, 8), (20, 5), (200, 60), (1, 1))
COLOURS = ((None, False), ('standard', True), ('256', False), ('truecolor', False))
TERMINALS = [Capabilities(*size, *colours, unicode=u) for size in SIZES for colours in COLOURS for u in (True, False)]
ATTRIBUTES = re.compile(r'\x1b\[[0-9;]*m')


def shown(view_state: Any, capabilities: Capabilities, pad: Pad | None = None, in_help: bool = False) -> str:
    return capabilities.written(screen(view_state, pad or Pad(), capabilities, in_help))


@pytest.mark.parametrize('kind', ['label', 'demonstration', 'feature_subset', 'relevance'])
@pytest.mark.parametrize('capabilities', TERMINALS, ids=str)
def test_every_screen_fits_its_terminal(made: Any, kind: str, capabilities: Capabilities) -> None:
    """Otherwise lines would wrap and push the question off the screen, on a small one or over a slow line."""
    person = made.Person()
    person.dialogue.look(made.many_objects(60), 1)
    person.progress(3, *(made.record(turn) for turn in range(1, 4)))
    view_state = person.asked(made.QUERIES[kind](5))
    now = about(view_state)
    for pad in (Pad(), Pad(now, '12'), Pad(now, 'fru', in_words=True), Pad(notice='long ' * 99)):
        for in_help in (False, True):
            lines = ATTRIBUTES.sub('', shown(view_state, capabilities, pad, in_help)).split('\n')
            assert len(lines) <= capabilities.height
            assert max(map(cell_len, lines)) <= capabilities.width
            assert capabilities.unicode or ''.join(lines).isascii()


@pytest.mark.parametrize('width', [40, 80])
def test_a_label_query_shows_all_that_it_takes_to_answer(person: Any, made: Any, width: int) -> None:
    """Otherwise the person could not know what is asked, about which thing, or how to say it."""
    person.progress(1, made.record(1))
    text = ' '.join(shown(person.asked(made.label(2)), Capabilities(width)).split())
    for part in (
        'Teaching as anna',
        'turn 2 of 7',
        'costs 1, which leaves 4 of 6 of the budget',
        'What is object 7?',
        'Object 7: right, at x 1.20 m, y 0.40 m',
        '[7]',
        '[m] main_dish [a] snack [f] fruit [b] beverage [n] none of these',
        'z undo',
        'turn 1 object 3 is fruit',
    ):
        assert part in text


def test_without_colours_nothing_but_characters_is_written(person: Any, made: Any) -> None:
    """Otherwise a terminal without colours, or a log, would be full of codes."""
    text = shown(person.asked(made.label(1)), Capabilities())
    assert '\x1b' not in text
    assert '▀' not in text


def test_colours_are_those_that_the_terminal_has(person: Any, made: Any) -> None:
    """A terminal of 256 colours shows the right ones, and one without no blocks of one colour."""
    view_state = person.asked(made.label(1))
    # rich keeps the codes of a style that it has once written, so that each kind of terminal needs colours of its own.
    assert '38;2;' in shown(view_state, Capabilities(colors='truecolor'))
    person.dialogue.see(np.full_like(made.picture_of(), 77), 2)
    view_state = person.dialogue.view_state()
    assert '38;2;' not in shown(view_state, Capabilities(colors='256'))
    assert '38;5;' in shown(view_state, Capabilities(colors='256'))
    monochrome = shown(view_state, Capabilities(colors='256', monochrome=True))
    assert '38;5;' not in monochrome
    assert '\x1b[1;7m' in monochrome
    assert '▀' not in monochrome


@settings(deadline=None)
@given(st.text(max_size=60), st.lists(st.text(min_size=1, max_size=30), min_size=2, max_size=6, unique=True))
def test_texts_from_the_robot_reach_the_terminal_as_text(made: Any, text: str, symbols: list[str]) -> None:
    """A text of a question cannot clear the screen, move the cursor, or make the terminal type."""
    hostile = f'\x1b[2J\x07\u202e{text}\r\n'
    person = made.Person()
    query = made.label(1, symbols=(hostile, *symbols), text=hostile)
    person.progress(1, made.record(3, symbol=hostile))
    view_state = person.asked(query)
    lines = [*shown(view_state, Capabilities()).split('\n'), question_line(query, False), farewell(view_state)]
    person.dialogue.say('?')
    view_state = person.taken(False, hostile)
    lines += shown(view_state, Capabilities()).split('\n')
    assert all(line.isprintable() for line in lines)
    assert any('\\x1b[2J' in line for line in lines)


def test_a_number_that_is_typed_shows_its_object(person: Any, made: Any) -> None:
    """Otherwise the person would learn only afterwards that they pointed at another thing."""
    view_state = person.asked(made.demonstration(1))
    pad, _ = press('1', Pad(), view_state)
    pad, _ = press('2', pad, view_state)
    text = shown(view_state, Capabilities(), pad)
    assert 'Object 12: back' in text
    assert '[12]' in text


def test_numbers_that_are_typed_are_marked_on_the_map(person: Any, made: Any) -> None:
    """Otherwise the person would lose count of forty things."""
    view_state = person.asked(made.relevance(1))
    text = shown(view_state, Capabilities(80, 30), Pad(about(view_state), '1,7'))
    assert 'Which of these things matter?' in text
    assert 'n if nothing here does: 1,7_' in text.replace('\n', ' ')
    assert 'Object 7: ' in text
    marked = screen(view_state, Pad(about(view_state), '1,12'), Capabilities(80, 30))
    styled = {
        line.plain[span.start : span.end] for line in marked for span in line.spans if 'reverse' in str(span.style)
    }
    assert styled == {'1', '[12]'}


def test_ticked_groups_are_marked(person: Any, made: Any) -> None:
    """Otherwise the person could not see what they are about to say."""
    view_state = person.asked(made.feature_subset(1))
    pad, _ = press('2', Pad(), view_state)
    assert '[x] 2 size' in shown(view_state, Capabilities(), pad)
    assert '[ ] 1 colour' in shown(view_state, Capabilities(), pad)


def test_an_object_that_has_gone_is_said_to_have_gone(person: Any, made: Any) -> None:
    """Otherwise the person would look for it and not find it."""
    assert 'Object 9 is not in view any more.' in shown(person.asked(made.label(1, object_id=9)), Capabilities())


def test_between_questions_the_robot_is_said_to_think(person: Any, made: Any) -> None:
    """Otherwise the person would believe that the program has stopped."""
    person.progress(3)
    assert 'thinks. 5 turns left.' in shown(person.dialogue.view_state(), Capabilities())


def test_a_camera_whose_projection_is_unknown_is_not_cut_out(person: Any, made: Any) -> None:
    """Otherwise the person would be shown some other part of the picture as the object."""
    person.dialogue.see(made.picture_of(480, 640), 2)
    text = shown(person.asked(made.label(1)), Capabilities())
    assert text.split('\n')[4].startswith('┌─')


def test_a_correction_says_what_it_corrects(person: Any, made: Any) -> None:
    """Otherwise the person would think that the robot asks the same thing again."""
    person.answered(made.label(1))
    person.dialogue.undo()
    text = shown(person.dialogue.view_state(), Capabilities())
    assert 'Correction of: object 7 is fruit' in text
    # Of the question that is shown, not how far the robot is meanwhile.
    assert 'turn 1 of 6 · correcting' in text


@pytest.mark.parametrize('kind', ['label', 'demonstration', 'feature_subset', 'relevance'])
@pytest.mark.parametrize('capabilities', [Capabilities(80, 24), Capabilities(80, 18), Capabilities(60, 40)], ids=str)
def test_the_map_stays_where_it_is_while_a_question_is_shown(made: Any, kind: str, capabilities: Capabilities) -> None:
    """Otherwise the number that somebody is about to point at would jump to another row."""
    person = made.Person()
    person.dialogue.look(made.many_objects(20), 1)
    view_state = person.asked(made.QUERIES[kind](5))
    long = Pad(notice='words ' * (capabilities.width // 4))
    pads = (Pad(), Pad(about(view_state), '1'), Pad(notice='one line'), long)
    screens = [shown(view_state, capabilities, pad) for pad in pads]
    person.progress(4, *(made.record(turn) for turn in range(1, 5)))
    screens += [shown(person.dialogue.view_state(), capabilities, pad) for pad in pads]
    person.dialogue.say('?')
    screens.append(shown(person.dialogue.view_state(), capabilities))
    rows = {tuple(n for n, line in enumerate(text.split('\n')) if set('┌└') & set(line)) for text in screens}
    assert len(rows) == 1
    ((top, bottom),) = rows
    assert bottom > top
    assert 'telling the robot' in screens[-1]


def test_numbers_beyond_all_measure_are_shown(person: Any, made: Any) -> None:
    """Otherwise one strange message would end a person's session."""
    query = made.label(1, symbols=('x' * 9000,) * 3000)
    query = replace(query, turns_left=10**4299, cost=float('inf'), budget_left=1e300)
    view_state = person.asked(query)
    assert 'very many' in shown(view_state, Capabilities())
    assert len(question_line(query, False)) < 3000


def test_a_question_that_waits_tells_the_time_that_is_left_now(person: Any, made: Any) -> None:
    """Otherwise a user who comes back would believe that there is more time than there is."""
    person.asked(made.label(2))
    person.progress(4)
    view_state = person.dialogue.view_state()
    assert 'turn 5 of 7' in shown(view_state, Capabilities())
    assert 'turns left 2' in question_line(view_state.prompt.query, False, view_state.progress)


def test_a_line_keeps_names_with_blanks_and_commas_apart(made: Any) -> None:
    """Otherwise a person would take one name for two, and be refused."""
    assert '[main dish, cup, none, ?, skip]' in question_line(made.label(1, symbols=('main dish', 'cup')), False)
    assert '[size,"bbox[0,1]" ? skip]' in question_line(made.feature_subset(1, ('size', 'bbox[0,1]')), False)


@pytest.mark.parametrize(
    ('content', 'words'), [((1, 12), 'of these things 1, 12 matter'), ((), 'of these things none matters')]
)
def test_what_matters_is_told_in_words(person: Any, made: Any, content: tuple[int, ...], words: str) -> None:
    """Otherwise a person could not check what they said, or find an earlier answer again."""
    query = made.relevance(1)
    answer = Answer('q1', 'a1', 'anna', Outcome.ANSWERED, content)
    assert said_in_words(query.action, answer) == words
    record = QueryRecord(1, QueryKind.RELEVANCE, None, None, 4.0, Outcome.ANSWERED, objects=content)
    assert recorded_in_words(record) == words
    nobody = replace(record, outcome=Outcome.UNANSWERED, objects=None)
    assert recorded_in_words(nobody) == 'which things matter: nobody answered'
    assert question_line(query, False).startswith('q1: Which of these things matter? [1,7,12 none ? skip] (costs 4')
