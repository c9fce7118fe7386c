"""The actions of a turn and their wording."""

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, Action, Costs, QueryKind, random_stream
from al_questioner.questioning import Episode
from al_questioner.questioning.candidates import candidates, choices
from al_questioner.questioning.question_wording import question_text

SYMBOLS = ('main_dish', 'snack', 'fruit')


@pytest.fixture
def scene(toy):
    return toy.scene(np.random.default_rng(0).normal(size=(2, 5)), object_ids=(7, 3))


def test_canonical_order(scene):
    """Weights, decisions and recordings rely on DQ by symbol, LQ by object, FSQ, NQ."""
    assert candidates(scene, SYMBOLS, Costs(), 10.0) == (
        Action(QueryKind.DEMONSTRATION, symbol='main_dish'),
        Action(QueryKind.DEMONSTRATION, symbol='snack'),
        Action(QueryKind.DEMONSTRATION, symbol='fruit'),
        Action(QueryKind.LABEL, object_id=7),
        Action(QueryKind.LABEL, object_id=3),
        Action(QueryKind.FEATURE_SUBSET),
        Action(QueryKind.NO_QUERY),
    )


def test_the_relevance_query_is_one_candidate_more_where_it_has_a_cost(toy, scene):
    """Otherwise the paper's candidates, and all recordings, would change for those who do not use it."""
    asked = candidates(scene, SYMBOLS, Costs(relevance=4.0), 10.0)
    assert len(asked) == len(SYMBOLS) + len(scene) + 3
    assert asked[-2:] == (Action(QueryKind.RELEVANCE), Action(QueryKind.NO_QUERY))
    assert (*asked[:-2], asked[-1]) == candidates(scene, SYMBOLS, Costs(), 10.0)
    assert Action(QueryKind.RELEVANCE) not in candidates(scene, SYMBOLS, Costs(relevance=4.0), 3.9)
    assert Action(QueryKind.RELEVANCE) in candidates(scene, SYMBOLS, Costs(relevance=0.0), 0.0)
    assert Action(QueryKind.RELEVANCE) not in candidates(toy.scene(np.empty((0, 5))), SYMBOLS, Costs(relevance=4), 9.0)


def test_what_has_a_single_answer_is_no_candidate(toy):
    """Otherwise it would be asked and paid for, and tell nothing."""
    one_group = toy.scene(np.zeros((2, 3)), names=('colour_red', 'colour_green', 'colour_blue'))
    assert Action(QueryKind.FEATURE_SUBSET) not in candidates(one_group, SYMBOLS, Costs(), 10.0)
    assert len(candidates(one_group, SYMBOLS, Costs(), 10.0)) == 3 + 2 + 1
    nothing = toy.scene(np.empty((0, 5)))
    subset, rest = Action(QueryKind.FEATURE_SUBSET), Action(QueryKind.NO_QUERY)
    assert candidates(nothing, SYMBOLS, Costs(), 10.0) == (subset, rest)
    nothing_of_one_group = toy.scene(np.empty((0, 1)), names=('size_height',))
    assert candidates(nothing_of_one_group, SYMBOLS, Costs(), 10.0) == (rest,)


def test_rounding_of_costs_does_not_lose_the_last_query(scene):
    """Three times 0.1 are 0.3, though not in floating point."""
    left = 0.3 - (0.1 + 0.1)
    assert left < 0.1
    assert len(candidates(scene, SYMBOLS, Costs(label=0.1), left)) == 3


def test_questions_in_plain_english():
    assert question_text(Action(QueryKind.LABEL, object_id=7), SYMBOLS) == 'What is object 7?'
    assert question_text(Action(QueryKind.DEMONSTRATION, symbol='snack'), SYMBOLS) == 'Can you show me a snack?'
    assert question_text(Action(QueryKind.DEMONSTRATION, symbol='apple'), SYMBOLS) == 'Can you show me an apple?'
    assert question_text(Action(QueryKind.DEMONSTRATION, symbol='cookies'), SYMBOLS) == 'Can you show me some cookies?'
    expected = 'Which properties matter for telling main dish, snack and fruit apart?'
    assert question_text(Action(QueryKind.FEATURE_SUBSET), SYMBOLS) == expected
    assert question_text(Action(QueryKind.RELEVANCE), SYMBOLS) == 'Which of these things matter?'
    with pytest.raises(ValueError, match='asks nothing'):
        question_text(Action(QueryKind.NO_QUERY), SYMBOLS)


def test_choices(scene):
    groups = ('colour', 'size')
    assert choices(Action(QueryKind.LABEL, object_id=7), scene, SYMBOLS, groups) == SYMBOLS
    assert choices(Action(QueryKind.DEMONSTRATION, symbol='snack'), scene, SYMBOLS, groups) == ('7', '3')
    assert choices(Action(QueryKind.FEATURE_SUBSET), scene, SYMBOLS, groups) == groups
    assert choices(Action(QueryKind.RELEVANCE), scene, SYMBOLS, groups) == ('7', '3')
    with pytest.raises(ValueError, match='no answers'):
        choices(Action(QueryKind.NO_QUERY), scene, SYMBOLS, groups)


STRATEGIES = ('dt_iros', 'dt_task', 'dt_task_env', 'rarest_demo', 'value_per_cost', 'random_fsq')


@pytest.mark.parametrize('strategy', STRATEGIES)
def test_a_question_whose_one_answer_is_known_is_not_put(toy, strategy):
    """Otherwise the only thing in view would be named again and again, and shown for what it was named."""
    episode = Episode(toy.settings(strategy, budget=50.0), random_stream(0, 'learner'))
    scene = toy.scene(np.zeros((1, 5)), object_ids=(4,))
    named_in = 0
    for turn in range(10):
        is_named = turn > 0 and episode.concepts.is_labelled(scene).all()
        named_in += is_named
        query = episode.ask(scene).query
        if query is None:
            continue
        kind = query.action.kind
        assert kind is QueryKind.FEATURE_SUBSET or not is_named
        right = {QueryKind.LABEL: 'snack', QueryKind.FEATURE_SUBSET: ('colour',)}
        episode.tell(toy.reply(query, right.get(kind, 4 if query.action.symbol == 'snack' else NO_SYMBOL)))
    assert named_in
