"""A person with nothing but `ros2 topic pub` must be understood, and never misunderstood."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.domain import Action, Answer, AnswerError, Content, Outcome, Query, QueryKind
from al_questioner.questioning import read_plain_answer, respelt

CHOICES = {
    QueryKind.LABEL: ('main_dish', 'snack'),
    QueryKind.DEMONSTRATION: ('7', '12'),
    QueryKind.FEATURE_SUBSET: ('colour', 'size', 'weight'),
    QueryKind.RELEVANCE: ('3', '10', '27'),
}


def query(kind: QueryKind, choices: tuple[str, ...] = ()) -> Query:
    return Query('q1', 1, Action(kind), choices or CHOICES[kind], 1.0, 5.0, 9, 0, 'What?')


@pytest.mark.parametrize(
    ('kind', 'text', 'content'),
    [
        *((QueryKind.LABEL, text, 'snack') for text in ('snack', 'ｓｎａｃｋ')),
        *((QueryKind.LABEL, text, 'main_dish') for text in ('  Main_Dish\n', 'main dish')),
        (QueryKind.LABEL, 'none', 'none'),
        *((QueryKind.DEMONSTRATION, text, 7) for text in ('7', '#7', ' Object #7')),
        *((QueryKind.DEMONSTRATION, text, 12) for text in ('object 12', '１２')),
        (QueryKind.DEMONSTRATION, 'None', 'none'),
        (QueryKind.FEATURE_SUBSET, 'colour,weight', ('colour', 'weight')),
        (QueryKind.FEATURE_SUBSET, 'Size , ', ('size',)),
        (QueryKind.FEATURE_SUBSET, '"size", colour', ('size', 'colour')),
        *(
            (QueryKind.RELEVANCE, text, (3, 10, 27))
            for text in ('3,10,27', ' 3 , 10,27\n', '3 10 27', '#3, #10、２７', '３，１０，27')
        ),
        *((QueryKind.RELEVANCE, text, (10, 3)) for text in ('10,3', 'object 10 and object 3', 'Objects 10, 3,')),
        *((QueryKind.RELEVANCE, text, (3,)) for text in ('3', '#3', 'object 3')),
        (QueryKind.RELEVANCE, '3,3', (3, 3)),
        *((QueryKind.RELEVANCE, text, ()) for text in ('none', ' None ')),
    ],
)
def test_words_of_the_contract_are_understood(kind: QueryKind, text: str, content: Content) -> None:
    """Otherwise a plain `ros2 topic pub` would not answer."""
    answer = read_plain_answer(text, query(kind))
    assert (answer.query_id, answer.outcome, answer.content) == ('q1', Outcome.ANSWERED, content)


@pytest.mark.parametrize('kind', list(CHOICES))
@pytest.mark.parametrize(
    ('text', 'outcome'),
    [
        *((text, Outcome.UNKNOWN) for text in ('?', '？', 'Unknown')),
        *((text, Outcome.SKIP) for text in ('skip', 'SKİP\n')),
    ],
)
def test_every_question_can_be_left_open(kind: QueryKind, text: str, outcome: Outcome) -> None:
    """Otherwise a person who does not know could not go on."""
    answer = read_plain_answer(text, query(kind))
    assert (answer.outcome, answer.content) == (outcome, None)


@pytest.mark.parametrize(
    ('kind', 'text'),
    [
        *((QueryKind.LABEL, text) for text in ('snacks', '', '7')),
        *((QueryKind.DEMONSTRATION, text) for text in ('8', 'snack')),
        *((QueryKind.FEATURE_SUBSET, text) for text in ('colour,smell', 'none', ' , ')),
    ],
)
def test_what_is_no_answer_is_refused_with_the_choices(kind: QueryKind, text: str) -> None:
    """Otherwise a slip of the finger would become a label, or the person would not learn what is expected."""
    with pytest.raises(AnswerError, match=query(kind).choices[0]):
        read_plain_answer(text, query(kind))


@pytest.mark.parametrize(
    ('kind', 'choices', 'text', 'content'),
    [
        (QueryKind.LABEL, ('Cup', 'cup'), 'cup', 'cup'),
        (QueryKind.LABEL, ('Cup', 'cup'), 'Cup', 'Cup'),
        (QueryKind.LABEL, ('Früchte', 'plate'), 'Fru\u0308chte', 'Früchte'),
        (QueryKind.LABEL, ('Fru\u0308chte', 'plate'), 'Früchte', 'Fru\u0308chte'),
        (QueryKind.LABEL, (' cup ', 'plate'), 'cup', ' cup '),
        (QueryKind.LABEL, ('skip', '?', '7'), 'skip', 'skip'),
        (QueryKind.LABEL, ('skip', '?', '7'), '7', '7'),
        (QueryKind.LABEL, ('None', 'cup'), 'None', 'None'),
        (QueryKind.LABEL, ('None', 'cup'), 'none', 'none'),
        (QueryKind.LABEL, ('a,b', 'cup'), 'a,b', 'a,b'),
        (QueryKind.FEATURE_SUBSET, ('bbox[0,1]', 'size'), 'bbox[0,1]', ('bbox[0,1]',)),
        (QueryKind.FEATURE_SUBSET, ('bbox[0,1]', 'size'), 'size, bbox[0,1]', ('size', 'bbox[0,1]')),
        (QueryKind.FEATURE_SUBSET, ('bbox[0, 1]', 'size'), '"bbox[0, 1]",size', ('bbox[0, 1]', 'size')),
        (QueryKind.FEATURE_SUBSET, ('x,y', 'x', 'y'), '"x","y"', ('x', 'y')),
        (QueryKind.FEATURE_SUBSET, ('x,y', 'x', 'y'), '"x,y"', ('x,y',)),
        (QueryKind.FEATURE_SUBSET, ('Size', 'size'), 'size', ('size',)),
    ],
)
def test_what_is_exactly_a_choice_is_that_choice(
    kind: QueryKind, choices: tuple[str, ...], text: str, content: Content
) -> None:
    """A word that no task file has ruled out is learnt as what it says, and can be said."""
    assert read_plain_answer(text, query(kind, choices)).content == content


@pytest.mark.parametrize(
    ('kind', 'choices', 'text', 'reason'),
    [
        (QueryKind.LABEL, ('Cup', 'cup'), 'CUP', 'could be Cup or cup'),
        (QueryKind.LABEL, ('Skip', 'cup'), 'SKIP', 'could be Skip or skip'),
        (QueryKind.FEATURE_SUBSET, ('x,y', 'x', 'y', 'z'), 'x,y,z', 'can be read in two ways'),
        (QueryKind.LABEL, (), 'snak', 'did you mean snack'),
        (QueryKind.LABEL, (), 'unkown', 'did you mean unknown'),
        (QueryKind.FEATURE_SUBSET, (), 'color,size', "'color' does not answer 'What\\?'; did you mean colour"),
        (QueryKind.LABEL, (), 'quti', 'did you mean quit'),
    ],
)
def test_what_may_mean_two_things_or_misses_one_is_refused_with_them(
    kind: QueryKind, choices: tuple[str, ...], text: str, reason: str
) -> None:
    """Otherwise the robot would guess, or leave the person to find out what is wrong with the word."""
    with pytest.raises(AnswerError, match=reason):
        read_plain_answer(text, query(kind, choices), others=('undo', 'quit'))


@pytest.mark.parametrize('word', ['fruit', 'hello'])
def test_a_word_that_only_looks_a_little_like_a_command_has_no_suggestion(word: str) -> None:
    """The word fruit is not answered with the advice to quit."""
    with pytest.raises(AnswerError) as caught:
        read_plain_answer(word, query(QueryKind.LABEL, ('cup', 'plate', 'cutlery')), others=('undo', 'help', 'quit'))
    assert 'did you mean' not in str(caught.value)


@pytest.mark.parametrize(
    ('content', 'expected'),
    [
        ('Fru\u0308chte', 'Früchte'),
        ('Früchte', 'Früchte'),
        ('früchte', 'früchte'),
        (('gro\u0308ße', 'size'), ('größe', 'size')),
        (7, 7),
        (None, None),
    ],
)
def test_names_of_a_document_are_known_in_any_form_of_unicode(content: Content, expected: Content) -> None:
    """Otherwise a teacher's program on a Mac would be told that the very word that it sent is unknown."""
    answer = Answer('q1', 'a1', 'mac', Outcome.ANSWERED, content)
    assert respelt(answer, ('Früchte', 'cup', 'größe', 'size')).content == expected


@pytest.mark.parametrize('kind', CHOICES)
def test_a_text_without_end_is_refused_in_a_short_line(kind: QueryKind) -> None:
    """Otherwise the log would be flooded, or a number of 5000 digits end the node."""
    for text in ('9' * 5000, 'a' * 100_000, '"' * 9999, ',' * 5000, 'a,' * 5000):
        with pytest.raises(AnswerError) as caught:
            read_plain_answer(text, query(kind))
        assert len(str(caught.value)) < 250


@given(st.text(max_size=40))
def test_random_text_is_refused_or_a_choice(text: str) -> None:
    """Otherwise any other text would slip through as a label."""
    asked = query(QueryKind.LABEL)
    try:
        answer = read_plain_answer(text, asked)
    except AnswerError:
        return
    assert answer.content in (*asked.choices, 'none', None)


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('3,99', "'99' does not answer 'What?'; expected numbers with commas between, of: 3, 10, 27, none, ?, skip"),
        ('snack', "'snack' does not answer"),
        ('3,none', "'3,none' does not answer 'What?': each of none, ?, skip stands alone"),
        ('3 ?', 'stands alone'),
        ('', 'does not answer'),
        ('3.5', "'3.5' does not answer"),
        ('-3', "'-3' does not answer"),
    ],
)
def test_a_list_of_things_is_never_guessed(text: str, reason: str) -> None:
    """A thing that is named by mistake would be learnt as one that matters, all others as clutter."""
    with pytest.raises(AnswerError) as caught:
        read_plain_answer(text, query(QueryKind.RELEVANCE))
    assert reason in str(caught.value)


def test_the_spelling_of_things_that_matter_is_left_alone() -> None:
    """Numbers have no Unicode form."""
    for content in ((3, 10), ()):
        answer = Answer('q1', 'a1', 'anna', Outcome.ANSWERED, content)
        assert respelt(answer, ('snack',)) == answer


@pytest.mark.parametrize('kind', [QueryKind.RELEVANCE, QueryKind.DEMONSTRATION])
def test_no_number_is_suggested_in_place_of_another(kind: QueryKind) -> None:
    """A person who takes such a suggestion names another thing."""
    with pytest.raises(AnswerError) as refused:
        read_plain_answer('100', query(kind, ('10', '1000', '3')))
    assert 'mean' not in str(refused.value)


@pytest.mark.parametrize('kind', [QueryKind.RELEVANCE, QueryKind.DEMONSTRATION])
def test_a_query_whose_choices_are_no_numbers_is_no_traceback(kind: QueryKind) -> None:
    """Another learner may have written it."""
    with pytest.raises(AnswerError, match="'cup' is no number of an object"):
        read_plain_answer('cup', query(kind, ('cup', 'plate')))
