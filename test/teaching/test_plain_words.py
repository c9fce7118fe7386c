"""A person with nothing but `ros2 topic pub` must be understood, and never misunderstood."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.domain import Action, AnswerError, Content, Outcome, Query, QueryKind
from al_questioner.teaching import read_plain_answer


def query(kind: QueryKind) -> Query:
    choices = {
        QueryKind.LABEL: ('main_dish', 'snack'),
        QueryKind.DEMONSTRATION: ('7', '12'),
        QueryKind.FEATURE_SUBSET: ('colour', 'size', 'weight'),
    }[kind]
    return Query('q1', 1, Action(kind), choices, 1.0, 5.0, 9, 0, 'What?')


@pytest.mark.parametrize(
    ('kind', 'text', 'content'),
    [
        (QueryKind.LABEL, 'snack', 'snack'),
        (QueryKind.LABEL, '  Main_Dish\n', 'main_dish'),
        (QueryKind.LABEL, 'none', 'none'),
        (QueryKind.DEMONSTRATION, '7', 7),
        (QueryKind.DEMONSTRATION, 'object 12', 12),
        (QueryKind.DEMONSTRATION, '#7', 7),
        (QueryKind.DEMONSTRATION, 'None', 'none'),
        (QueryKind.FEATURE_SUBSET, 'colour,weight', ('colour', 'weight')),
        (QueryKind.FEATURE_SUBSET, 'Size , ', ('size',)),
    ],
)
def test_words_of_the_contract_are_understood(kind: QueryKind, text: str, content: Content) -> None:
    """A plain `ros2 topic pub` would not answer."""
    answer = read_plain_answer(text, query(kind))
    assert (answer.query_id, answer.outcome, answer.content) == ('q1', Outcome.ANSWERED, content)


@pytest.mark.parametrize('kind', [QueryKind.LABEL, QueryKind.DEMONSTRATION, QueryKind.FEATURE_SUBSET])
@pytest.mark.parametrize(('text', 'outcome'), [('?', Outcome.UNKNOWN), ('skip', Outcome.SKIP)])
def test_every_question_can_be_left_open(kind: QueryKind, text: str, outcome: Outcome) -> None:
    """A person who does not know could not go on."""
    answer = read_plain_answer(text, query(kind))
    assert (answer.outcome, answer.content) == (outcome, None)


@pytest.mark.parametrize(
    ('kind', 'text'),
    [
        (QueryKind.LABEL, 'snacks'),
        (QueryKind.LABEL, ''),
        (QueryKind.LABEL, '7'),
        (QueryKind.DEMONSTRATION, '8'),
        (QueryKind.DEMONSTRATION, 'snack'),
        (QueryKind.FEATURE_SUBSET, 'colour,smell'),
        (QueryKind.FEATURE_SUBSET, 'none'),
        (QueryKind.FEATURE_SUBSET, ' , '),
    ],
)
def test_what_is_no_answer_is_refused_with_the_choices(kind: QueryKind, text: str) -> None:
    """A slip of the finger would become a label, or the person would not learn what is expected."""
    with pytest.raises(AnswerError, match=query(kind).choices[0]):
        read_plain_answer(text, query(kind))


@given(st.text(max_size=40))
def test_random_text_is_refused_or_a_choice(text: str) -> None:
    """Any other text would slip through as a label."""
    asked = query(QueryKind.LABEL)
    try:
        answer = read_plain_answer(text, asked)
    except AnswerError:
        return
    assert answer.content in (*asked.choices, 'none', None)
