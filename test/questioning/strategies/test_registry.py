"""Choices of each strategy."""

import dataclasses

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, Action, Outcome, QueryKind, QueryRecord, SettingsError
from al_questioner.questioning import STRATEGIES, UncertaintySampling, make_strategy
from al_questioner.questioning.strategies.choice import choose_best, settled_actions
from al_questioner.questioning.strategies.value_per_cost import VALUE_FEATURES

AUTOMATIC = [name for name in STRATEGIES if name != 'human']
CONSTANTS = ('reach', 'doubt', 'decline', 'pace')
LABELLING = ('u_sampling_fsq', 'random_fsq', 'farthest_fsq', 'typiclust', 'probcover')
CONTROLS = (*LABELLING, 'rarest_demo')
SUBSET_ASKED = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.ANSWERED, ('size',))


def context_of(toy, labels=(), table=None, **changes):
    scene = None if table is None else toy.scene(table)
    return toy.context(labels, scene, **{'history': (SUBSET_ASKED,), **changes})


def chosen(name, context, seed=0, weights=None):
    choice = make_strategy(name, weights or {}).choose(context, np.random.default_rng(seed))
    return context.candidates[choice.index]


def test_uncertainty_sampling_asks_about_the_largest_entropy(toy):
    context = context_of(toy, ['snack', 'fruit', 'snack', 'main_dish'])
    q = context.probabilities
    p = q / q.sum(axis=1, keepdims=True)
    entropy = [-sum(value * np.log(value) for value in row) for row in p]
    assert chosen('u_sampling', context).object_id == int(np.argmax(entropy))


def test_uncertainty_sampling_considers_label_queries_only(toy):
    context = context_of(toy)
    choice = make_strategy('u_sampling', {}).choose(context, np.random.default_rng(0))
    considered = [a.kind for a, u in zip(context.candidates, choice.utilities, strict=True) if not np.isnan(u)]
    assert considered == [QueryKind.LABEL] * 6
    assert chosen('u_sampling', context_of(toy, spent=20.0)).kind is QueryKind.NO_QUERY


@pytest.mark.parametrize('name', ['dt_iros', 'dt_task', 'dt_task_env'])
def test_decision_theoretic_maximises_weights_times_features(toy, name):
    context = context_of(toy, ['snack', 'fruit'])
    weights = toy.weights[name]
    choice = make_strategy(name, weights).choose(context, np.random.default_rng(0))
    order = ('discriminability', 'class_uniformity', 'instance_variation', 'prediction_margin',
             'budget_consumption', 'remaining_time', 'non_query_time')  # fmt: skip
    utility = [sum(weights.get(f, 0) * v for f, v in zip(order, row, strict=True)) for row in choice.features]
    considered = np.array([action.kind is not QueryKind.FEATURE_SUBSET for action in context.candidates])
    np.testing.assert_allclose(choice.utilities[considered], np.array(utility)[considered], atol=1e-14)
    assert np.isnan(choice.utilities[~considered]).all(), 'it was asked before'
    assert utility[choice.index] == pytest.approx(np.array(utility)[considered].max())


@pytest.mark.parametrize('name', CONTROLS)
def test_controls_start_with_one_subset_query(toy, name):
    """Once, whatever came of it, and only if a first example can be paid as well."""
    fresh = {'history': (), 'spent': 0.0, 'turn': 1}
    assert chosen(name, context_of(toy, **fresh)).kind is QueryKind.FEATURE_SUBSET
    assert chosen(name, context_of(toy)).kind is not QueryKind.FEATURE_SUBSET
    assert chosen(name, context_of(toy, **fresh, budget=2.0)).kind is not QueryKind.FEATURE_SUBSET


@pytest.mark.parametrize('name', LABELLING)
def test_controls_never_ask_about_a_labelled_view(toy, name):
    """Not even when the label was none; and they rest when all is known."""
    context = context_of(toy, ['snack', NO_SYMBOL, 'fruit'])
    assert {chosen(name, context, seed).object_id for seed in range(30)} <= {3, 4, 5}
    assert chosen(name, context_of(toy, ['snack'] * 6)).kind is QueryKind.NO_QUERY


@pytest.mark.parametrize('name', LABELLING)
def test_controls_do_not_insist_when_the_teacher_does_not_know(toy, name):
    """A teacher who did not know is not asked the same again until the scene changes."""
    asked = tuple(QueryRecord(2, QueryKind.LABEL, i, None, 1.0, Outcome.UNKNOWN) for i in range(5))
    context = context_of(toy, history=(SUBSET_ASKED, *asked))
    assert chosen(name, context).object_id == 5
    changed = context_of(toy, history=(SUBSET_ASKED, *asked), scene_turn=3)
    assert {chosen(name, changed, seed).kind for seed in range(5)} == {QueryKind.LABEL}


def test_random_asks_about_every_unlabelled_view(toy):
    context = context_of(toy, ['snack', 'snack'])
    assert {chosen('random_fsq', context, seed).object_id for seed in range(60)} == {2, 3, 4, 5}


LINE = np.zeros((6, 5))
LINE[:, 2] = [0, 1, 2, 3, 4, 9]


def test_farthest_by_hand(toy):
    """On a line 0, 1, 2, 3, 4, 9 with 0 labelled, 9 is farthest; with 0 and 9 labelled, 4."""
    context = context_of(toy, ['snack'], LINE)
    assert chosen('farthest_fsq', context).object_id == 5
    context.concepts.label(5, context.scene.features[5], 'fruit', 2)
    assert chosen('farthest_fsq', dataclasses.replace(context)).object_id == 4


def test_farthest_looks_at_the_chosen_features_only(toy):
    table = LINE.copy()
    table[2, 3:] = 1000
    context = context_of(toy, ['snack'], table)
    assert chosen('farthest_fsq', context).object_id == 2
    context.concepts.restrict_to_groups(['size'])
    assert chosen('farthest_fsq', dataclasses.replace(context)).object_id == 5


def test_rarest_demonstration_asks_for_the_fewest_examples(toy):
    assert chosen('rarest_demo', context_of(toy, ['snack', 'fruit', 'fruit'])).symbol == 'main_dish'
    tied = {chosen('rarest_demo', context_of(toy, ['fruit']), seed).symbol for seed in range(20)}
    assert tied == {'main_dish', 'snack'}


def test_rarest_demonstration_moves_on_when_there_is_none(toy):
    """A symbol that is not here, or was only shown again, is not asked for again until the scene changes."""
    in_vain = QueryRecord(2, QueryKind.DEMONSTRATION, None, 'main_dish', 2.0, Outcome.ANSWERED)
    history = (SUBSET_ASKED, in_vain)
    labels = ['fruit', 'fruit', 'snack']
    assert chosen('rarest_demo', context_of(toy, labels, history=history)).symbol == 'snack'
    assert chosen('rarest_demo', context_of(toy, labels, history=history, scene_turn=3)).symbol == 'main_dish'

    again = context_of(toy, ['fruit', 'fruit', 'main_dish'], history=(
        *history, QueryRecord(2, QueryKind.DEMONSTRATION, 5, 'snack', 2.0, Outcome.ANSWERED),
    ))  # fmt: skip
    for _ in range(2):
        again.concepts.label(5, again.scene.features[5], 'snack', 2)
    assert chosen('rarest_demo', again).symbol == 'fruit'


def test_rarest_demonstration_is_paced_over_the_scenes(toy):
    """Four scenes, budget 20: no more than 5 may be spent in the first, 10 by the end of the second."""
    for turn, spent, kind in (
        (3, 2.0, QueryKind.DEMONSTRATION),
        (3, 4.0, QueryKind.NO_QUERY),
        (6, 4.0, QueryKind.DEMONSTRATION),
        (6, 8.0, QueryKind.DEMONSTRATION),
        (10, 9.0, QueryKind.NO_QUERY),
        (20, 18.0, QueryKind.DEMONSTRATION),
    ):
        assert chosen('rarest_demo', context_of(toy, turn=turn, spent=spent)).kind is kind, (turn, spent)


def test_ties_are_broken_at_random_among_the_best_only(toy):
    context = context_of(toy)
    for best, tied, worse in ((1.0, 1.0 + 1e-12, 0.999), (-1.0, -1.0 - 1e-12, -2.0)):
        utilities = np.full(len(context.candidates), np.nan)
        utilities[[2, 5, 7]] = best, tied, worse
        picked = {choose_best(context, utilities, np.random.default_rng(seed)).index for seed in range(30)}
        assert picked == {2, 5}


def test_what_is_settled_is_not_asked_again(toy):
    """Until the scene changes: no answer, no such thing here. For ever: the relevant features."""
    history = (
        QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.ANSWERED, ('size',)),
        QueryRecord(2, QueryKind.LABEL, 4, None, 1.0, Outcome.SKIP),
        QueryRecord(2, QueryKind.LABEL, 2, 'snack', 1.0, Outcome.ANSWERED),
        QueryRecord(2, QueryKind.DEMONSTRATION, None, 'snack', 2.0, Outcome.ANSWERED),
        QueryRecord(2, QueryKind.DEMONSTRATION, 3, 'fruit', 2.0, Outcome.ANSWERED),
        QueryRecord(2, QueryKind.DEMONSTRATION, None, 'main_dish', 2.0, Outcome.UNKNOWN),
    )
    subset = Action(QueryKind.FEATURE_SUBSET)
    assert settled_actions(context_of(toy, history=history)) == {
        subset,
        Action(QueryKind.LABEL, object_id=4),
        Action(QueryKind.DEMONSTRATION, symbol='snack'),
        Action(QueryKind.DEMONSTRATION, symbol='main_dish'),
    }
    in_the_very_turn_of_the_change = context_of(toy, history=history, scene_turn=2)
    assert settled_actions(in_the_very_turn_of_the_change) == settled_actions(context_of(toy, history=history))
    assert settled_actions(context_of(toy, history=history, scene_turn=3)) == {subset}


def test_what_is_known_not_to_be_here_is_not_to_be_shown(toy):
    """Each view was named as something else: the answer is sure to be that there is none."""
    demonstrations = [Action(QueryKind.DEMONSTRATION, symbol=symbol) for symbol in toy.symbols]
    labels = ['snack', NO_SYMBOL, 'snack', 'fruit', NO_SYMBOL, 'fruit']
    known = context_of(toy, labels, history=())
    assert settled_actions(known) == set(demonstrations[:1])
    assert settled_actions(context_of(toy, labels[:5], history=())) == set()
    for name in AUTOMATIC:
        for seed in range(5):
            assert chosen(name, known, seed, toy.weights.get(name)) != demonstrations[0]


@pytest.mark.parametrize('outcome', [Outcome.UNKNOWN, Outcome.SKIP])
def test_the_relevant_features_are_asked_for_a_second_time_if_there_was_no_answer(toy, outcome):
    """The answer is worth more than any other, but a teacher who does not know it is not asked in every scene."""
    subset = Action(QueryKind.FEATURE_SUBSET)
    first, second = (QueryRecord(turn, subset.kind, None, None, 2.0, outcome) for turn in (1, 6))
    unheard = dataclasses.replace(first, outcome=Outcome.UNANSWERED)
    for history, scene_turn, settled in (
        ((first,), 1, True),
        ((first,), 6, False),
        ((first, second), 6, True),
        ((first, second), 11, True),
        ((unheard,), 6, True),
    ):
        context = context_of(toy, turn=12, history=history, scene_turn=scene_turn)
        assert (subset in settled_actions(context)) is settled
        for name in (*CONTROLS, 'value_per_cost'):
            assert (chosen(name, context) == subset) is not settled


@pytest.mark.parametrize('strategy', ['u_sampling', 'dt_iros', 'dt_task', 'dt_task_env'])
def test_no_strategy_repeats_a_question_that_got_no_answer(toy, strategy):
    """Otherwise it leaves the state as it was, so without a rule the same question would be the best for ever."""
    weights = toy.weights.get(strategy, {})
    first = chosen(strategy, context_of(toy, ['snack', 'fruit']), weights=weights)
    record = QueryRecord(2, first.kind, first.object_id, first.symbol, 1.0, Outcome.UNKNOWN)
    again = context_of(toy, ['snack', 'fruit'], history=(record,))
    assert chosen(strategy, again, weights=weights) != first


@pytest.mark.parametrize(
    ('name', 'weights', 'reason'),
    [
        ('dt_task', {}, 'dt_task needs weights'),
        ('dt_iros', {'beauty': 1}, "dt_iros does not use 'beauty'; it uses discriminability, class_uniformity$"),
        ('dt_iros', {'discriminability': 1, 'budget_consumption': -1}, "dt_iros does not use 'budget_consumption'"),
        ('dt_task', {'discriminability': 1, 'non_query_time': -1}, "dt_task does not use 'non_query_time'"),
        ('dt_task_env', {'discriminability': 1, 'gain': 1}, "dt_task_env does not use 'gain'"),
        ('dt_task_env', {'discriminability': 1, 'reach': 1}, "dt_task_env does not use 'reach'"),
        ('value_per_cost', {'gain': 1, 'discriminability': 1}, "does not use 'discriminability'"),
        ('value_per_cost', {'gian': 0}, f"does not use 'gian'; it uses {', '.join((*VALUE_FEATURES, *CONSTANTS))}$"),
        *(
            ('value_per_cost', {'gain': 1, name: value}, f'{name} must be a number of 1e-06 or more, not {value}')
            for name, value in zip(CONSTANTS, (0.0, np.inf, np.nan, -1.0), strict=True)
        ),
    ],
)
def test_weights_that_do_not_fit(name, weights, reason):
    """Weights of another strategy must not pass as this one's."""
    with pytest.raises(SettingsError, match=reason):
        make_strategy(name, weights)


def test_uncertainty_sampling_can_be_kept_from_asking_again(toy):
    """Otherwise the study of whether it may ask again would vary nothing."""
    context = context_of(toy, ['snack'] * 5)
    again = UncertaintySampling().choose(context, np.random.default_rng(0))
    never = UncertaintySampling(repeats=False).choose(context, np.random.default_rng(0))
    assert np.isfinite(again.utilities).sum() == 6
    assert [context.candidates[i].object_id for i in np.flatnonzero(np.isfinite(never.utilities))] == [5]
    everything = context_of(toy, ['snack'] * 6)
    nothing = UncertaintySampling(repeats=False).choose(everything, np.random.default_rng(0))
    assert everything.candidates[nothing.index].kind is QueryKind.NO_QUERY
