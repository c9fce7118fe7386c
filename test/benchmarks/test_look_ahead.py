"""The benchmark of the look-ahead: that it measures what it says, and that it runs."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest


def state_of(kind):
    from look_ahead_parts.states import clustered_state

    return clustered_state(np.random.default_rng(1), n=9, things=3, symbols=3, m=20, kind=kind)


@pytest.fixture
def state():
    from look_ahead_parts.states import SHIPPED

    return state_of(SHIPPED)


@pytest.mark.parametrize('kind', ['SHIPPED', 'SHIPPED_RBF', 'SMALL_RBF'])
def test_all_ways_make_the_same_table(kind):
    """The rivals solve the same problem, so that the ratios of their times mean something."""
    from look_ahead_parts import refitting, states

    state = state_of(getattr(states, kind))
    truth = refitting.until_convergence(state)
    assert np.isfinite(truth).all()
    np.testing.assert_allclose(refitting.distinct_fits(state), truth, rtol=0, atol=1e-4)
    balanced = state.balanced(truth)
    np.testing.assert_allclose(refitting.own_refits(state), balanced, rtol=0, atol=1e-6)
    np.testing.assert_allclose(refitting.own_refit(state, 2, 1), balanced[2, 1], rtol=0, atol=1e-6)
    normalised = truth / truth.sum(axis=-1, keepdims=True)
    np.testing.assert_allclose(refitting.as_users_write(state), normalised, rtol=0, atol=1e-4)


def test_what_ships_is_what_is_measured():
    """A benchmark of other settings would tell nothing about a robot."""
    from look_ahead_parts.states import SHIPPED

    from al_questioner.concepts.kernel import KERNEL_SHAPES
    from al_questioner.simulation import episode_settings, load_task

    settings = episode_settings(load_task('prepare_lunch'), 'u_sampling')
    assert SHIPPED.amplitude == settings.amplitude
    assert SHIPPED.shape == KERNEL_SHAPES[settings.kernel_shape]
    assert SHIPPED.class_balance == settings.class_balance


def test_a_wrong_table_is_noticed(state):
    """The check shows the error and the other action."""
    from look_ahead_parts.actions import choose, task_weights
    from look_ahead_parts.exactness import compare, report_actions

    truth = state.models().look_ahead(state.scene)
    wrong = truth.copy()
    q, weights = state.models().predict_proba(state.scene), task_weights()
    best = choose(state, q, truth, weights)
    other = (best.action + 1) % len(state.scene)
    wrong[other] = np.where(np.arange(3)[:, None] == 0, 0.999, 0.001)
    compared = compare(state, wrong, truth, weights)
    assert compared.error > 0.1
    assert not compared.same
    assert compared.margin == pytest.approx(best.margin)
    assert report_actions([compared], 'nothing')['differ'] == 1


def test_the_random_states_hold_what_the_table_says():
    """The thousand states of the check are not all easy."""
    from look_ahead_parts.states import random_state

    rng = np.random.default_rng(0)
    states = [random_state(rng) for _ in range(300)]
    numbers, amplitudes = [len(state.labels) for state in states], [state.kind.amplitude for state in states]
    assert min(numbers) == 0
    assert max(numbers) > 140
    assert min(amplitudes) < 2 < 250 < max(amplitudes) < 300
    assert {0.0, 0.5} == {state.kind.class_balance for state in states}
    saturations = [state.kind.shape.saturation for state in states]
    assert 100 < sum(np.isinf(saturations)) < 200
    assert len(set(saturations)) > 30
    assert sum(len(state.labels) > 1 and len(set(state.labels)) == 1 for state in states) > 10
    shown_again = [(state.scene[:, None] == state.features).all(axis=2).any() for state in states]
    assert 50 < sum(shown_again) < 150


@pytest.mark.slow
def test_it_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]):
    """Otherwise the tables would rot unseen, since nobody measures every day."""
    monkeypatch.setenv('OMP_NUM_THREADS', '1')  # the script would set it for good
    import look_ahead
    from look_ahead_parts import side_by_side

    monkeypatch.setattr(side_by_side, 'THINGS', 2)
    monkeypatch.setattr(look_ahead, 'QUICK_SIZES', (8,))
    monkeypatch.setattr(look_ahead, 'QUICK_GROWTH', ((0, 5), (2, 3), (2,)))
    monkeypatch.setattr(look_ahead, 'QUICK_POOL', 20)
    path = tmp_path / 'look_ahead.json'
    assert look_ahead.main(['--quick', '--states', '5', '--repeats', '1', '--json', str(path)]) == 0
    figures = json.loads(path.read_text())
    for of_kind in figures['side_by_side'].values():
        assert of_kind['8'][side_by_side.COLD]['error'] < 1e-6
    assert figures['exactness']['errors']['1.0'] < 1e-6
    assert figures['exactness']['actions']['differ'] == 0
    assert figures['growth']['5,3,2']['default'] == 'exact'
    assert figures['pool']['chunks'] == 1
    assert 'GFLOP/s' in capsys.readouterr().out


def test_an_approximating_model_is_told_from_an_exact_one(state, monkeypatch: pytest.MonkeyPatch):
    """The growth table says when the cheaper mode switches on."""
    from look_ahead_parts.growth import approximates

    from al_questioner.concepts import concept_models

    assert not approximates(state.models(), state)
    monkeypatch.setattr(concept_models, 'EXACT_OPERATIONS', 1.0)
    assert approximates(state.models(), state)


def test_unusable_arguments_are_refused(capsys: pytest.CaptureFixture[str]):
    import look_ahead

    assert look_ahead.main(['--states', '0']) == 2
    assert capsys.readouterr().err == '--repeats, --states and --whole must be 1 or more\n'
