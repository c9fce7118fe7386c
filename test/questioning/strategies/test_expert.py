"""The scripted expert asks as the paper tells: frugally, early about features, evenly over classes and time."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from al_questioner.domain import NO_SYMBOL, Outcome, QueryKind, QueryRecord, random_stream
from al_questioner.questioning import Episode, make_strategy
from al_questioner.questioning.strategies.expected_utility import expected_features


def demonstration(toy, seed, budget=15.0, turns=30, change_interval=10, unknown_rate=0.0):
    world = toy.world(seed, n_objects=8, change_interval=change_interval, unknown_rate=unknown_rate)
    own = toy.settings('expert', budget, turns, change_interval=change_interval)
    episode = Episode(own, random_stream(seed, 'learner'))
    return episode, toy.play(episode, world)


def chosen(context, seed=0):
    choice = make_strategy('expert', {}).choose(context, np.random.default_rng(seed))
    return context.candidates[choice.index]


@pytest.mark.parametrize('seed', range(8))
def test_asks_once_and_early_which_features_matter(toy, seed):
    """The paper: always within the first five turns."""
    episode, _ = demonstration(toy, seed)
    asked = [record.turn for record in episode.records if record.kind is QueryKind.FEATURE_SUBSET]
    assert len(asked) == 1
    assert asked[0] <= 5


def test_when_it_asks_for_the_features_depends_on_the_seed(toy):
    """Otherwise all demonstrations would show the same."""
    first = [
        next(r.turn for r in demonstration(toy, seed, turns=6)[0].records if r.kind is QueryKind.FEATURE_SUBSET)
        for seed in range(12)
    ]
    assert len(set(first)) >= 3


@pytest.mark.parametrize('seed', range(8))
def test_spends_the_budget_evenly_so_that_each_scene_finds_some_left(toy, seed):
    """The paper: spreading the budget over the time gives a more diverse sample than spending it at once."""
    episode, _ = demonstration(toy, seed)
    by_turn = np.zeros(31)
    for record in episode.records:
        by_turn[record.turn :] += record.cost
    for change in (10, 20):
        assert 15 * change / 30 - 2 <= by_turn[change] <= 15 * change / 30 + 3
    assert 14 <= by_turn[30] <= 15


@pytest.mark.parametrize('seed', range(4))
def test_asks_mostly_for_labels_and_covers_the_classes(toy, seed):
    """The paper: most queries of the least costly kind, representative examples of each class quickly."""
    episode, _ = demonstration(toy, seed)
    kinds = Counter(record.kind for record in episode.records)
    assert kinds[QueryKind.LABEL] > sum(kinds.values()) / 2
    assert min(episode.positives.values()) >= 1


def test_a_large_budget_is_asked_from_at_every_turn(toy):
    """An expert is not frugal where nothing is scarce; nothing is asked once all views are labelled."""
    episode, decisions = demonstration(toy, 0, budget=500.0, turns=16, change_interval=4)
    idle = [d for d in decisions if d.query is None]
    assert len(episode.records) >= 15
    assert len(idle) <= 1


def test_every_decision_shows_what_was_weighed(toy):
    """Otherwise nobody could learn from decisions whose candidates have no features."""
    for decision in demonstration(toy, 1)[1]:
        assert np.isfinite(decision.features).all()
        assert np.nanmax(decision.utilities) == decision.utilities[decision.chosen]


SUBSET = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.UNKNOWN)


def test_the_rarest_class_is_what_it_asks_about(toy):
    """There are two examples of snack and of fruit, one of main_dish: the likeliest main_dish is asked about."""
    table = np.zeros((8, 5))
    table[:, 0] = [0, 5, 5, 10, 10, 0.2, 5.2, 10.2]
    labels = ['main_dish', 'snack', 'snack', 'fruit', 'fruit']
    context = toy.context(labels, toy.scene(table), turn=8, spent=4.0, history=(SUBSET,))
    choice = make_strategy('expert', {}).choose(context, np.random.default_rng(0))
    assert context.candidates[choice.index].object_id == 5
    np.testing.assert_array_equal(choice.features, expected_features(context))


def test_asks_for_a_demonstration_of_a_class_that_stays_without_example(toy):
    """Otherwise waiting for chance would leave a class untaught; what is not here is not asked for again."""
    labels, turn = ['snack', 'snack', 'fruit', NO_SYMBOL], {'turn': 10, 'spent': 4.0, 'scene_turn': 5}
    not_here = QueryRecord(6, QueryKind.DEMONSTRATION, None, 'main_dish', 2.0, Outcome.ANSWERED)
    for history, kind in (((SUBSET,), QueryKind.DEMONSTRATION), ((SUBSET, not_here), QueryKind.LABEL)):
        assert chosen(toy.context(labels, history=history, **turn)).kind is kind
    context = toy.context([*labels, NO_SYMBOL, NO_SYMBOL], history=(SUBSET,), **turn)
    for seed in range(5):
        assert chosen(context, seed).kind is QueryKind.NO_QUERY, 'all that is here has been named'


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    seed=st.integers(0, 1000),
    budget=st.sampled_from([0.0, 1.0, 2.0, 3.0, 7.5, 40.0]),
    turns=st.integers(1, 12),
    unknown_rate=st.sampled_from([0.0, 0.5, 1.0]),
)
def test_keeps_every_limit(toy, seed, budget, turns, unknown_rate):
    """An expert that overspends, or asks what was just refused, would be no example to follow."""
    episode, decisions = demonstration(toy, seed, budget, turns, 3, unknown_rate)
    assert episode.spent <= budget
    for first, second in zip(episode.records, episode.records[1:], strict=False):
        same = (first.kind, first.object_id) == (second.kind, second.object_id)
        unanswered = first.outcome is not Outcome.ANSWERED and first.kind is QueryKind.LABEL
        assert not (same and unanswered)
    assert sum(d.query is not None for d in decisions) == len(episode.records)
