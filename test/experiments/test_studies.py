"""Studies: each differs from the comparison in the one thing that it is about."""

from __future__ import annotations

import dataclasses

import pytest

from al_questioner.domain import DECISION_FEATURES, Classifiers, SettingsError
from al_questioner.experiments.plan import SELECTORS, Cell, Variation, shipped_weights
from al_questioner.experiments.playing import play_episode
from al_questioner.experiments.studies import AMPLITUDES, MOST_SAMPLES, STUDIES, make_studies

BASE = Variation(weights={name: found.values for name, found in shipped_weights().items()})
VARIED = {
    'amplitude': 'classifiers',
    'kernel': 'classifiers',
    'weights_iros': 'weights',
    'weights_task': 'weights',
    'change_interval': 'change_interval',
    'selector': 'selector',
    'repeats': 'repeats',
    'wrong_answers': 'wrong_rate',
    'synchrony': 'synchrony',
    'ablation': 'weights',
}


@pytest.mark.parametrize('name', STUDIES)
def test_a_study_varies_one_thing(name: str) -> None:
    """Otherwise a difference on the page would be due to something else."""
    (study,) = make_studies([name], BASE, range(20))
    assert study.name == name
    assert study.plans
    assert study.own not in study.plans
    seen = []
    for plan in study.plans.values():
        varied = {
            field.name
            for field in dataclasses.fields(Variation)
            if getattr(plan.variation, field.name) != getattr(BASE, field.name)
        }
        assert varied == {VARIED[name]}
        assert plan.samples == tuple(range(MOST_SAMPLES))
        seen.append(plan.variation)
    assert all(a != b for i, a in enumerate(seen) for b in seen[:i])


@pytest.mark.parametrize('own', [Classifiers(), Classifiers(100.0, 'rbf', 0.0), Classifiers(4.0, 'rbf', 0.0)])
def test_the_classifiers_are_varied_around_those_of_the_comparison(own: Classifiers) -> None:
    """Otherwise amplitudes would be compared under one kernel, and the page be about another."""
    base = dataclasses.replace(BASE, classifiers=own)
    amplitudes, kernels = make_studies(['amplitude', 'kernel'], base, range(2))
    found = {plan.variation.classifiers for plan in amplitudes.plans.values()}
    assert found == {own._replace(amplitude=amplitude) for amplitude in AMPLITUDES} - {own}
    assert amplitudes.own == f'{own.amplitude:g}'
    (label,) = kernels.plans
    other = ('grouped', 0.5) if own.kernel_shape == 'rbf' else ('rbf', 0.0)
    assert kernels.plans[label].variation.classifiers == Classifiers(own.amplitude, *other)
    assert (label, kernels.own) == tuple(f'{shape}, class balance {b:g}' for shape, b in (other, own[1:]))


def test_the_ablation_takes_each_feature_away_once() -> None:
    """Otherwise a feature without which nothing changes would be reported for another."""
    (study,) = make_studies(['ablation'], BASE, range(2))
    weights = BASE.weights['dt_task_env']
    used = [feature for feature in DECISION_FEATURES if weights[feature]]
    assert list(study.plans) == [f'without {feature}' for feature in used]
    for feature, plan in zip(used, study.plans.values(), strict=True):
        assert plan.variation.weights['dt_task_env'] == {**weights, feature: 0.0}
        assert plan.variation.weights['dt_task'] == BASE.weights['dt_task']


@pytest.mark.parametrize('name', ['weights_iros', 'weights_task'])
def test_hand_set_weights_are_shares(name: str) -> None:
    """Otherwise weights that do not add up to one would be compared with others that do."""
    (study,) = make_studies([name], BASE, range(1))
    strategy = name.replace('weights', 'dt')
    for plan in study.plans.values():
        assert plan.strategies == (strategy,)
        assert sum(plan.variation.weights[strategy].values()) == pytest.approx(1)


def test_selectors_and_repeats_reach_u_sampling_alone() -> None:
    """Otherwise the study would report the same episodes under other names."""
    cell = Cell('prepare_lunch', 15, 15, 'u_sampling', 0)
    plain = play_episode(cell, BASE).accuracy
    for selector in SELECTORS:
        varied = play_episode(cell, dataclasses.replace(BASE, selector=selector)).accuracy
        assert (varied == plain) == (selector == BASE.selector)
    never = play_episode(cell, dataclasses.replace(BASE, repeats=False))
    asked = [(record.object_id, (record.turn - 1) // 10) for record in never.queries]
    assert len(set(asked)) == len(asked)
    other = dataclasses.replace(cell, strategy='random_fsq')
    changed = dataclasses.replace(BASE, repeats=False, selector='none')
    assert play_episode(other, changed).accuracy == play_episode(other, BASE).accuracy


def test_unknown_studies_are_named() -> None:
    """Otherwise a typing error would be found out after the run."""
    with pytest.raises(SettingsError, match='unknown study'):
        make_studies(['weather'], BASE, range(2))
    with pytest.raises(SettingsError, match='named twice'):
        make_studies(['repeats', 'repeats'], BASE, range(2))
