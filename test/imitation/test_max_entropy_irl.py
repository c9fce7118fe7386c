"""Feature matching: its parts against hand-made cases, the whole against weights that are known."""

import dataclasses

import numpy as np
import pytest
from scipy.special import softmax

from al_questioner.domain import InputError, QueryKind
from al_questioner.imitation.identifiability import identify
from al_questioner.imitation.max_entropy_irl import (
    Iteration,
    Matching,
    MatchingSettings,
    best_window,
    gauss_newton_step,
    jacobian_of_counts,
    match_features,
)
from al_questioner.imitation.rollouts import Rollout, Simulator, SoftmaxQuestioner
from al_questioner.questioning import FEATURE_SETS, Episode
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings, turns
from shared.lunches import TASK, teacher_of

FEW = MatchingSettings(iterations=16, rollouts=4, patience=16, seed=1)


def test_the_jacobian_is_that_of_a_single_choice():
    """With one decision the counts are the chosen features, and d E[phi]/dw = Cov_p(phi) exactly."""
    rng = np.random.default_rng(0)
    features, weights = rng.random((5, 7)), rng.normal(size=7)
    p = softmax(features @ weights)
    mean = p @ features
    exact = (features - mean).T @ ((features - mean) * p[:, None])
    drawn = rng.choice(5, size=40_000, p=p)
    rollouts = [Rollout(features[i : i + 1], features[i : i + 1] - mean) for i in drawn]
    np.testing.assert_allclose(jacobian_of_counts([rollouts], np.ones(7)), exact, atol=0.004)


def test_the_jacobian_knows_that_the_future_does_not_change_the_past():
    """Two independent choices: the second must not seem to move the features of the first; exact in the mean."""
    rng = np.random.default_rng(2)
    features = rng.random((2, 4, 7))
    p = softmax(features @ rng.normal(size=7), axis=1)
    means = np.einsum('tc,tcf->tf', p, features)
    exact = np.mean([(f - m).T @ ((f - m) * q[:, None]) for f, m, q in zip(features, means, p, strict=True)], axis=0)
    drawn = [np.array([features[t, rng.choice(4, p=p[t])] for t in (0, 1)]) for _ in range(6_000)]
    rollouts = [Rollout(chosen, chosen - means) for chosen in drawn]
    np.testing.assert_allclose(jacobian_of_counts([rollouts], np.ones(7)), exact, atol=0.008)


def test_the_jacobian_is_in_units_of_the_scale():
    """Otherwise features of small spread would hardly move."""
    rng = np.random.default_rng(0)
    rollouts = [Rollout(*rng.normal(size=(2, 5, 7))) for _ in range(20)]
    scale = np.array([1, 2, 0.5, 1, 1, 0, 4.0])
    plain, scaled = (jacobian_of_counts([rollouts], s) for s in (np.ones(7), scale))
    unit = np.where(scale > 0, 1 / np.where(scale > 0, scale, 1), 0)
    np.testing.assert_allclose(scaled, plain * unit[:, None] * unit)


def test_steps_lead_to_a_gap_of_zero_where_counts_are_linear():
    """On E[phi] = J w + b the iteration must converge, also where the gap itself points the wrong way."""
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(7, 7))
    goal, weights = rng.normal(size=7), np.zeros(7)
    for _ in range(4000):
        weights = weights + gauss_newton_step(jacobian, goal - jacobian @ weights, np.ones(7, dtype=bool))
    assert np.linalg.norm(goal - jacobian @ weights) < 0.05 * np.linalg.norm(goal)


def test_a_step_is_never_long():
    """Otherwise one unlucky estimate would throw the weights away."""
    step = gauss_newton_step(1e-3 * np.eye(7), np.full(7, 1e6), np.ones(7, dtype=bool))
    assert np.linalg.norm(step) <= 0.5 + 1e-12


def test_rollouts_do_not_depend_on_the_process(experts):
    """Otherwise the same seed would give other weights on another machine."""
    weights = np.array([1, 1, 1, 1, -3, 0, -3.0])
    found = []
    for jobs in (1, 2):
        with Simulator(experts, jobs) as simulator:
            found.append([r for each in simulator.roll_out(weights, 2, 'x') for r in each])
    for one, other in zip(*found, strict=True):
        np.testing.assert_array_equal(one.features, other.features)
        np.testing.assert_array_equal(one.scores, other.scores)
    assert not np.array_equal(found[0][0].features, found[0][1].features)


def test_the_score_sums_to_zero_on_average(experts):
    """E[grad log p] = 0 for any policy; a wrong score would give a wrong Jacobian."""
    weights = np.array([2, 1, 1, 1, -3, 0, -3.0])
    with Simulator(experts[:1]) as simulator:
        scores = np.array([r.scores.sum(axis=0) for r in simulator.roll_out(weights, 60, 'y')[0]])
    error = scores.std(axis=0, ddof=1) / np.sqrt(len(scores))
    assert (np.abs(scores.mean(axis=0)) <= 4 * error + 1e-12).all()


def test_the_same_seed_finds_the_same_in_any_number_of_processes(experts):
    """Otherwise training would be a lottery."""
    short = dataclasses.replace(FEW, iterations=2, rollouts=2)
    free = identify(experts)
    one, other = (match_features(experts, [], dataclasses.replace(short, jobs=jobs), free) for jobs in (1, 2))
    np.testing.assert_array_equal(one.weights, other.weights)


def test_the_gap_falls(experts):
    """Otherwise training would not train."""
    seen = []
    one = match_features(experts, [], FEW, identify(experts), lambda number, iteration: seen.append(number))
    late = np.mean([iteration.gap for iteration in one.iterations[-8:]], axis=0)
    assert np.linalg.norm(late) < 0.5 * np.linalg.norm(one.iterations[0].gap)
    assert seen == list(range(1, len(one.iterations) + 1))
    assert one.weights[5] == 0.0
    assert one.weights[4] < 0


def test_without_a_world_there_is_nothing_to_roll_out_in(made):
    """The error tells the user of a real robot what to use instead."""
    shown = made.synthetic(np.ones(7), 0, 5)
    with pytest.raises(InputError, match='use --method choice'):
        match_features([shown], [], FEW, identify([shown]))


def test_the_window_with_the_smallest_validation_gap_is_kept():
    """Otherwise the last iterations, or those that fit the training best, would be taken for the best ones."""

    def iterations(gaps, validation_gaps):
        ones = np.eye(7)[0]
        return [Iteration(np.zeros(7), g * ones, v * ones) for g, v in zip(gaps, validation_gaps, strict=True)]

    falling, late_best = np.linspace(5, 1, 30), np.abs(np.arange(30) - 14.5)
    assert best_window(iterations(falling, late_best)) == 19
    assert best_window(iterations(falling, falling)) == 29
    assert best_window(iterations(falling[:4], falling[:4])) == 3
    assert best_window(iterations(falling[:6], [3, 2, 1, 4, 8, 16])) == 2, 'not where it had grown'


def test_a_validation_gap_that_did_not_stay_small_is_told():
    """Otherwise weights would be taken for good because the gap closed where they were learnt."""
    ones = np.eye(7)[0]
    way = tuple(Iteration(np.zeros(7), g * ones, v * ones) for g, v in ((9, 8.0), (2, 1.5), (1, 1.0), (0.5, 1.0)))

    def after(validation_gap, iterations=way):
        return Matching(np.zeros(7), iterations, len(iterations) - 1, 0.4 * ones, validation_gap * ones)

    smallest = after(0).validation_gaps['smallest']
    assert smallest == pytest.approx(11.5 / 4)
    assert not after(1.9 * smallest).validation_failed
    assert after(2.1 * smallest).validation_failed
    flat = (way[2],) * 3
    assert after(1.1, flat).validation_failed, 'no smaller than before'


def test_the_validation_gap_is_that_of_the_demonstrations_held_out(experts):
    """Otherwise the gap over those that were learnt from would be told for it."""
    short = dataclasses.replace(FEW, iterations=2, rollouts=2)
    found = match_features(experts[:1], experts[1:], short, identify(experts))
    assert not np.array_equal(found.gap, found.validation_gap)
    alone = match_features(experts[:1], [], short, identify(experts[:1]))
    np.testing.assert_array_equal(alone.gap, alone.validation_gap)


def test_a_demonstration_that_was_cut_off_is_compared_with_as_many_turns(experts):
    """Otherwise ten recorded turns would be held against the thirty of a whole rollout."""
    cut = dataclasses.replace(experts[0], turns=4, steps=experts[0].steps[:4])
    with Simulator([cut]) as simulator:
        ((rollout,),) = simulator.roll_out(np.zeros(7), 1, 'z')
    assert rollout.features.shape == rollout.scores.shape == (4, 7)


def records_of(strategy, weights, budget, turn_count):
    """Queries in a lunch's world of a softmax over the features of a strategy, and the world."""
    draws = SoftmaxQuestioner(np.array(weights), FEATURE_SETS[strategy])
    settings = episode_settings(TASK, strategy, budget, turn_count)
    episode = Episode(settings, np.random.default_rng(0), strategy=draws)
    world = PerceivedWorld(WorldSpec(TASK, 0, 0).open())
    return [record for _, record in turns(episode, world, teacher_of(TASK, 0)) if record], world


def test_settled_questions_are_not_drawn():
    """Otherwise the policy would ask the feature subset query again and again, as no learner does."""
    records, _ = records_of('dt_task_env', [0, 0, 0, 0, 200.0, 0, 0], 20, 8)
    assert [record.kind for record in records].count(QueryKind.FEATURE_SUBSET) <= 1


def test_what_is_worthless_to_the_strategy_is_not_drawn():
    """Otherwise feature counts would be matched by questions that no learner with these weights asks."""
    # Indifferent, but for silence: without scene changes, things that are labelled would soon be asked about again.
    records, world = records_of('value_per_cost', [0, 0, 0, 0, -50.0], 500, 30)
    asked = []
    for record in records:
        if record.kind is QueryKind.LABEL:
            scene = world.scene(record.turn)
            asked.append((record.object_id, scene.features[scene.index_of(record.object_id)].tobytes()))
    assert len(asked) == len(set(asked)) > 10
