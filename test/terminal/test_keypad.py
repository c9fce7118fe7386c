"""Meanings of the keys."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from al_questioner.domain import AnswerError
from al_questioner.questioning import read_plain_answer
from al_questioner.terminal.commands import Explain, Say, Wish, read_line
from al_questioner.terminal.keypad import COMMANDS, Pad, letters, press

KEYS = [*COMMANDS, 'enter', 'backspace', 'escape', 'up', 'down', 'left', 'right', 'tab', 'f1', *' :17fé']


def pressed(view_state: Any, *keys: str) -> list[object]:
    """Return the command of these keys, pressed one after another."""
    pad, found = Pad(), []
    for key in keys:
        pad, command = press(key, pad, view_state)
        if command is not None:
            found.append(command)
    return found


def explained(view_state: Any, key: str, text: str) -> Explain:
    """Check that a key alone brings an explanation with this text."""
    (command,) = pressed(view_state, key)
    assert isinstance(command, Explain)
    assert text in command.text
    return command


def test_a_symbol_has_the_first_free_letter_of_its_name() -> None:
    """Otherwise people could not guess the keys, or one key would have two meanings."""
    keys = {'snack': 'a', 'fruit': 'f', 'salad': 'l', 'frog': 'r', 'nnn': 'b'}
    assert letters(list(keys)) == keys


def test_no_key_says_another_name_than_the_one_that_begins_with_it() -> None:
    """The first letter of an apple does not say that it is a snack."""
    assert letters(['snack', 'apple', 'Äpfel']) == {'snack': 'c', 'apple': 'a', 'Äpfel': 'p'}


@pytest.mark.parametrize(
    ('symbols', 'key', 'alike', 'command'),
    [
        (('screwdriver', 'cup'), 's', 'for screwdriver press r', Say('skip')),
        (('Screwdriver', 'cup'), 'S', 'for Screwdriver press r', Say('skip')),
        (('nut', 'cup'), 'n', 'for nut press t', Say('none')),
        (('unit', 'cup'), 'u', 'for unit press i', Say('?')),
        (('quiche', 'cup'), 'q', 'for quiche press i', Wish.QUIT),
        (('zucchini', 'cup'), 'z', 'for zucchini press i', Wish.UNDO),
    ],
)
def test_the_first_letter_of_a_name_is_a_command_only_if_it_is_pressed_twice(
    person: Any, made: Any, symbols: tuple[str, ...], key: str, alike: str, command: object
) -> None:
    """A person who presses s for a screwdriver does not skip the question and pay for it."""
    view_state = person.asked(made.label(1, symbols=symbols))
    why = explained(view_state, key, alike)
    assert pressed(view_state, key, key) == [why, command]
    assert pressed(view_state, key, 'c', key) == [why, Say('cup'), why]
    assert pressed(view_state, key, 'h', key) == [why, Wish.HELP, why]
    # Where numbers are asked for, no name is said by a letter.
    assert pressed(person.asked(made.demonstration(2)), key) == [command]


@pytest.mark.parametrize(
    ('group', 'key', 'command'),
    [('size', 's', Say('skip')), ('noise', 'n', Say('none')), ('Unit', 'U', Say('?')), ('zone', 'z', Wish.UNDO)],
)
def test_the_first_letter_of_a_group_is_a_command_only_if_it_is_pressed_twice(
    person: Any, made: Any, group: str, key: str, command: object
) -> None:
    """A person who presses s for size does not skip the question, and q for quality does not end the conversation."""
    view_state = person.asked(made.feature_subset(1, ('colour', group)))
    why = explained(view_state, key, f'for {group} press 2')
    assert pressed(view_state, key, key) == [why, command]
    assert pressed(view_state, key, '2', 'enter') == [why, Say(group)]
    assert pressed(view_state, '1', key, key) == [why, command]
    assert pressed(view_state, 'q') == [Wish.QUIT]


def test_a_group_beyond_the_digits_is_ticked_otherwise(person: Any, made: Any) -> None:
    """There is no key 10."""
    view_state = person.asked(made.feature_subset(1, (*'abcdefgij', 'size')))
    explained(view_state, 's', 'for size use arrows and space')


def test_a_capital_is_no_choice_where_another_symbol_begins_so(person: Any, made: Any) -> None:
    """The first letter of A1 does not say a."""
    view_state = person.asked(made.label(1, symbols=('a', 'A1')))
    text = '"A" could mean two things: for a press a, for A1 press 1'
    assert explained(view_state, 'A', text).text == text
    assert pressed(view_state, 'a', '1') == [Say('a'), Say('A1')]
    assert pressed(person.asked(made.label(2, symbols=('Apple', 'Ape'))), 'A', 'a') == [Say('Apple'), Say('Apple')]
    assert pressed(person.asked(made.label(3, symbols=('a', 'b1'))), 'A') == [Say('a')]


@settings(deadline=None)
@given(st.lists(st.text(min_size=1, max_size=8), unique=True, max_size=80))
def test_keys_are_distinct_and_no_commands(symbols: list[str]) -> None:
    """Otherwise a key would answer when the person wants to quit, or say one of two things."""
    keys = letters(symbols)
    assert len(set(keys.values())) == len(keys) >= min(len(symbols), 20)
    assert not {key.lower() for key in keys.values()} & COMMANDS.keys()


@pytest.mark.parametrize(
    ('key', 'word'), [('f', 'fruit'), ('F', 'fruit'), ('n', 'none'), ('?', '?'), ('u', '?'), ('a', 'snack')]
)
def test_one_key_answers_a_label_query(person: Any, made: Any, key: str, word: str) -> None:
    """Otherwise a person would have to type a hundred names."""
    assert pressed(person.asked(made.label(1)), key) == [Say(word)]


def test_digits_and_enter_answer_a_demonstration_query(person: Any, made: Any) -> None:
    """Otherwise the first digit of a number would be taken for all of it."""
    view_state = person.asked(made.demonstration(1))
    assert pressed(view_state, '1', '7', 'backspace', '2', 'enter') == [Say('12')]
    assert pressed(view_state, 'n') == [Say('none')]
    assert pressed(view_state, 'backspace') == [Wish.UNDO]
    assert isinstance(pressed(view_state, 'enter')[0], Explain)
    assert isinstance(pressed(view_state, '1', 'f')[0], Explain)


def test_numbers_and_enter_answer_a_relevance_query(person: Any, made: Any) -> None:
    """A comma or a blank parts two numbers; a slip is taken back, and no number at all is no answer."""
    view_state = person.asked(made.relevance(1))
    assert pressed(view_state, *'1,12', 'enter') == [Say('1,12')]
    assert pressed(view_state, *'1 3', 'backspace', *' , 7 ', 'enter') == [Say('1,7')]
    assert pressed(view_state, 'n') == [Say('none')]
    assert pressed(view_state, 'u') == [Say('?')]
    explained(view_state, 'enter', 'type the numbers of the things that matter')
    explained(view_state, 'x', 'is no digit')
    (notice,) = pressed(view_state, *'1,n')
    assert isinstance(notice, Explain)
    many = [*','.join(map(str, range(100))), 'enter']
    assert pressed(view_state, *many) == [Say(','.join(map(str, range(100))))]


def test_ticks_and_enter_answer_a_feature_subset_query(person: Any, made: Any) -> None:
    """Otherwise more than one property could not be named, or a slip not be taken back."""
    view_state = person.asked(made.feature_subset(1))
    assert pressed(view_state, '1', '3', '3', '9', ' ', 'right', ' ', 'enter') == [Say('colour,weight')]
    assert pressed(view_state, 'left', ' ', 'enter') == [Say('weight')]
    assert isinstance(pressed(view_state, 'enter')[0], Explain)


def test_groups_with_a_comma_can_be_ticked(person: Any, made: Any) -> None:
    """Ticked groups are read as these groups, and not refused."""
    query = made.feature_subset(1, ('x', 'y', 'x,y', 'size'))
    for keys, groups in (('12', ('x', 'y')), ('3', ('x,y',)), ('34', ('x,y', 'size'))):
        (said,) = pressed(person.asked(query), *keys, 'enter')
        assert isinstance(said, Say)
        assert read_plain_answer(said.text, query).content == groups


@pytest.mark.parametrize('kind', ['label', 'demonstration', 'feature_subset', 'relevance'])
def test_commands_are_the_same_at_every_question(person: Any, made: Any, kind: str) -> None:
    """Otherwise a person could not quit or get help at some question."""
    view_state = person.asked(made.QUERIES[kind](1))
    for key, wish in {'z': Wish.UNDO, 'backspace': Wish.UNDO, 'h': Wish.HELP, 'q': Wish.QUIT}.items():
        assert pressed(view_state, key) == [wish]
    assert pressed(view_state, ':', 's', 'k', 'i', 'x', 'backspace', 'p', 'enter') == [Say('skip')]
    assert pressed(view_state, ':', 'q', 'escape') == []


def test_between_questions_keys_answer_nothing(person: Any, made: Any) -> None:
    """Otherwise a second press would answer a question that nobody has seen."""
    view_state = person.dialogue.view_state()
    assert pressed(view_state, 'f', 'n', '?', 'enter') == []
    assert pressed(view_state, 'h', 'q') == [Wish.HELP, Wish.QUIT]


def test_what_was_typed_at_one_question_is_not_carried_to_the_next(person: Any, made: Any) -> None:
    """Otherwise digits that were meant for another question would be part of an answer."""
    pad, _ = press('1', Pad(), person.asked(made.demonstration(1)))
    pad, command = press('2', pad, person.asked(made.demonstration(2)))
    assert (pad.typed, command) == ('2', None)


@settings(deadline=None)
@given(
    st.sampled_from(['label', 'demonstration', 'feature_subset', 'relevance']),
    st.lists(st.sampled_from(KEYS) | st.characters()),
)
def test_no_keys_fail_and_every_answer_of_the_keypad_is_one(made: Any, kind: str, keys: list[str]) -> None:
    """Otherwise a cat on the keyboard would end the session, or say what the robot cannot read."""
    view_state = made.Person().asked(made.QUERIES[kind](1))
    for command in pressed(view_state, *(key for key in keys if key != ':')):
        if isinstance(command, Say) and command.text in view_state.prompt.query.choices:
            assert read_plain_answer(command.text, view_state.prompt.query).content is not None
    pressed(view_state, *keys)


@settings(deadline=None)
@given(st.text(max_size=40), st.sampled_from(['label', 'demonstration', 'feature_subset', 'relevance']))
def test_every_line_is_an_answer_or_is_explained(made: Any, line: str, kind: str) -> None:
    """Otherwise a script or a person would see a traceback, or nothing at all."""
    person = made.Person()
    query = person.asked(made.QUERIES[kind](1)).prompt.query
    command = read_line(line)
    if isinstance(command, Explain):
        assert command.text
    if isinstance(command, Say):
        try:
            expected = read_plain_answer(line, query, 'anna')
        except AnswerError:
            with pytest.raises(AnswerError, match='expected '):
                person.dialogue.say(command.text)
        else:
            person.dialogue.say(command.text)
            answer = person.sent[0][1]
            assert (answer.outcome, answer.content) == (expected.outcome, expected.content)


@pytest.mark.parametrize(('line', 'wish'), [(' Undo ', Wish.UNDO), ('help', Wish.HELP), ('QUIT', Wish.QUIT)])
def test_commands_can_be_typed(line: str, wish: Wish) -> None:
    """Otherwise a script could neither correct nor end itself."""
    assert read_line(line) is wish


def test_a_line_that_is_exactly_a_choice_is_that_choice() -> None:
    """Otherwise a robot whose symbols no task file has ruled out could not be told of one."""
    assert read_line('undo', ('undo', 'cup')) == Say('undo')
    assert read_line('Undo', ('undo', 'cup')) is Wish.UNDO
    assert read_line('ｕｎｄｏ') is Wish.UNDO
