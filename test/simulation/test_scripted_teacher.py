"""The scripted teacher must tell the truth, err exactly as often as told, and answer alike after a restart."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Mapping

import pytest

from al_questioner.domain import NO_SYMBOL, Action, Content, Outcome, Query, QueryKind, SettingsError
from al_questioner.simulation import ScriptedTeacher

SYMBOLS = ('fruit', 'snack', 'beverage')
TRUTH = {1: 'fruit', 2: 'snack', 3: 'snack', 4: NO_SYMBOL}
GROUPS = ('colour', 'size', 'base', 'noise')


def query(kind: QueryKind, number: int = 1, object_id: int | None = None, symbol: str | None = None) -> Query:
    choices = SYMBOLS if kind is QueryKind.LABEL else GROUPS
    return Query(f'q{number}', 1, Action(kind, object_id, symbol), choices, 1.0, 9.0, 9, 0, 'What?')


def teacher(**rates: float | bool) -> ScriptedTeacher:
    return ScriptedTeacher(SYMBOLS, ('size', 'colour', 'shape'), seed=3, **rates)


@pytest.mark.parametrize(
    ('asked', 'outcome', 'content'),
    [
        *((query(QueryKind.LABEL, object_id=i), Outcome.ANSWERED, symbol) for i, symbol in TRUTH.items()),
        (query(QueryKind.LABEL, object_id=99), Outcome.UNKNOWN, None),
        (query(QueryKind.DEMONSTRATION, symbol='beverage'), Outcome.ANSWERED, NO_SYMBOL),
        (query(QueryKind.FEATURE_SUBSET), Outcome.ANSWERED, ('colour', 'size')),
    ],
)
def test_answers_are_true(asked: Query, outcome: Outcome, content: Content) -> None:
    """Without an error rate no label is wrong, and nothing is shown that is not there."""
    answer = teacher().answer(asked, TRUTH)
    assert (answer.outcome, answer.content) == (outcome, content)


def test_demonstrations_show_every_example_and_no_other() -> None:
    """Otherwise a demonstration would show another thing, or always the same."""
    shown = {teacher().answer(query(QueryKind.DEMONSTRATION, n, symbol='snack'), TRUTH).content for n in range(60)}
    assert shown == {2, 3}


MANY = dict.fromkeys(range(10, 16), 'snack') | {1: 'fruit'}


def test_what_is_known_is_not_shown_while_there_are_others() -> None:
    """Otherwise two units of the budget would be spent for what was said before."""
    asked = query(QueryKind.DEMONSTRATION, symbol='snack')
    for number in range(20):
        some = dataclasses.replace(asked, query_id=f'q{number}', known=(1, 10, 11, 13, 99))
        assert teacher().answer(some, MANY).content in (12, 14, 15)
        everything = dataclasses.replace(some, known=tuple(MANY))
        assert teacher().answer(everything, MANY).content in range(10, 16)
        assert teacher(wrong_rate=1.0).answer(dataclasses.replace(some, known=(2,)), TRUTH).content in (1, 4)
    assert {
        teacher(repeat_shown=True).answer(dataclasses.replace(some, query_id=f'q{number}'), MANY).content
        for number in range(60)
    } == set(range(10, 16))


def test_what_it_named_is_not_shown_where_nothing_is_told_of_what_is_known() -> None:
    """Otherwise beside a learner of another make, it would show the same thing again."""
    one = teacher()
    one.answer(query(QueryKind.LABEL, 1, object_id=12), MANY)
    asked = [query(QueryKind.DEMONSTRATION, number, symbol='snack') for number in range(2, 7)]
    shown = [one.answer(each, MANY).content for each in asked]
    assert set(shown) == {10, 11, 13, 14, 15}
    assert [one.answer(each, MANY).content for each in asked] == shown, 'asked again, it says the same'
    assert one.answer(query(QueryKind.DEMONSTRATION, 7, symbol='snack'), MANY).content in range(10, 16)


def test_a_question_without_choices_is_not_understood() -> None:
    """Otherwise a strange query on the topic would put a teacher that errs into its error state for good."""
    asked = dataclasses.replace(query(QueryKind.FEATURE_SUBSET), choices=())
    for rate in (0.0, 1.0):
        assert teacher(wrong_rate=rate).answer(asked, TRUTH).outcome is Outcome.UNKNOWN


def test_rates_of_errors_are_kept() -> None:
    """Otherwise studies of teacher error would state another rate than the one that was simulated."""
    erring = teacher(wrong_rate=0.3, unknown_rate=0.2)
    n = 2000
    answers = [erring.answer(query(QueryKind.LABEL, number, object_id=1), TRUTH) for number in range(n)]
    unknown = sum(answer.outcome is Outcome.UNKNOWN for answer in answers)
    wrong = Counter(answer.content for answer in answers if answer.outcome is Outcome.ANSWERED)
    four_deviations = 4 * (0.3 * 0.7 * n) ** 0.5
    assert abs(unknown - 0.2 * n) < four_deviations
    assert abs(n - unknown - wrong['fruit'] - 0.3 * n) < four_deviations
    assert set(wrong) == {*SYMBOLS, NO_SYMBOL}


def test_wrong_demonstrations_and_groups_are_wrong() -> None:
    """Otherwise a teacher who always errs would be right about demonstrations or feature groups."""
    erring = teacher(wrong_rate=1.0)
    for number in range(30):
        assert erring.answer(query(QueryKind.DEMONSTRATION, number, symbol='snack'), TRUTH).content in (1, 4)
        groups = erring.answer(query(QueryKind.FEATURE_SUBSET, number), TRUTH).content
        assert len({'colour', 'size'} ^ set(groups)) == 1


def test_restarted_teacher_answers_alike() -> None:
    """Otherwise a teacher that died and came back would tell another story."""
    asked = [query(QueryKind.LABEL, number, object_id=2) for number in range(50)]
    once = [teacher(wrong_rate=0.5).answer(each, TRUTH) for each in asked]
    again = [teacher(wrong_rate=0.5).answer(each, TRUTH) for each in reversed(asked)]
    assert once == again[::-1]


@pytest.mark.parametrize(
    'rates',
    [
        {'wrong_rate': -0.1},
        {'unknown_rate': 1.1},
        {'wrong_rate': float('nan')},
        {'wrong_rate': 0.6, 'unknown_rate': 0.6},
    ],
)
def test_impossible_rates_are_refused(rates: dict[str, float]) -> None:
    """Otherwise a mistyped rate would be simulated as something else."""
    with pytest.raises(SettingsError, match='rate'):
        teacher(**rates)


TABLE = {number: 'snack' if number % 4 == 0 else NO_SYMBOL for number in range(40)}
MATTERING = tuple(range(0, 40, 4))


def which_matter(number: int = 1, things: Mapping[int, str] = TABLE) -> Query:
    asked = query(QueryKind.RELEVANCE, number)
    return dataclasses.replace(asked, choices=tuple(map(str, things)))


def test_what_matters_is_what_has_a_symbol() -> None:
    """Also where nothing does, and of the things that were asked about alone."""
    assert teacher().answer(which_matter(), TABLE).content == MATTERING
    assert teacher().answer(which_matter(), dict.fromkeys(TABLE, NO_SYMBOL)).content == ()
    assert teacher().answer(which_matter(things={4: 'snack', 5: ''}), TABLE).content == (4,)
    empty = teacher().answer(which_matter(things={}), {})
    assert (empty.outcome, empty.content) == (Outcome.ANSWERED, ())


@pytest.mark.parametrize(('omission', 'false_alarm'), [(0.1, 0.05), (1.0, 0.0), (0.0, 1.0), (0.3, 0.0)])
def test_things_are_left_out_and_added_as_often_as_told(omission: float, false_alarm: float) -> None:
    """Otherwise it would be measured against another teacher than the page says."""
    erring = teacher(relevance_omission=omission, relevance_false_alarm=false_alarm)
    answers = [set(erring.answer(which_matter(number), TABLE).content) for number in range(400)]
    left_out = sum(len(set(MATTERING) - named) for named in answers) / (400 * 10)
    added = sum(len(named - set(MATTERING)) for named in answers) / (400 * 30)
    # Three standard errors.
    assert abs(left_out - omission) <= 3 * (omission * (1 - omission) / 4000) ** 0.5
    assert abs(added - false_alarm) <= 3 * (false_alarm * (1 - false_alarm) / 12000) ** 0.5
    assert answers == [set(erring.answer(which_matter(number), TABLE).content) for number in range(400)]


def test_each_thing_is_misjudged_by_itself() -> None:
    """A teacher who overlooks one thing in ten rarely overlooks all, or none, at once."""
    erring = teacher(relevance_omission=0.5)
    counts = Counter(len(erring.answer(which_matter(number), TABLE).content) for number in range(400))
    mean = sum(count * times for count, times in counts.items()) / 400
    variance = sum((count - mean) ** 2 * times for count, times in counts.items()) / 400
    assert variance == pytest.approx(10 * 0.25, rel=0.3)


def test_a_wrong_answer_misjudges_one_thing_and_an_unknown_one_none() -> None:
    """The other rates mean what they mean at other questions."""
    for number in range(40):
        named = set(teacher(wrong_rate=1.0).answer(which_matter(number), TABLE).content)
        assert len(named ^ set(MATTERING)) == 1
    assert teacher(unknown_rate=1.0).answer(which_matter(), TABLE).outcome is Outcome.UNKNOWN


@pytest.mark.parametrize('rate', ['relevance_omission', 'relevance_false_alarm'])
def test_impossible_chances_are_refused(rate: str) -> None:
    for value in (-0.1, 1.1, float('nan')):
        with pytest.raises(SettingsError, match=rate):
            teacher(**{rate: value})


def test_choices_that_are_no_numbers_do_not_matter() -> None:
    """Another learner may have written the query; the node goes on."""
    asked = dataclasses.replace(which_matter(), choices=('cup', '4', '5'))
    assert teacher().answer(asked, TABLE).content == (4,)


def test_what_the_learner_has_no_word_for_is_none() -> None:
    """A learner of some of the symbols of a table would refuse the answer, and hear it again and again."""
    asked = dataclasses.replace(query(QueryKind.LABEL, object_id=1), choices=SYMBOLS[1:])
    teacher = ScriptedTeacher(SYMBOLS, (), 0)
    assert teacher.answer(asked, {1: SYMBOLS[0]}).content == NO_SYMBOL
    assert teacher.answer(asked, {1: SYMBOLS[1]}).content == SYMBOLS[1]
    wrong = ScriptedTeacher(SYMBOLS, (), 0, wrong_rate=1.0)
    assert wrong.answer(asked, {1: SYMBOLS[0]}).content in SYMBOLS[1:]
