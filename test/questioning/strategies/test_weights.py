"""Weights from YAML."""

from dataclasses import replace

import pytest

from al_questioner.domain import EpisodeSettings, InputError, random_stream
from al_questioner.questioning import Episode, load_weights, make_strategy, read_weights
from shared.checkout import ROOT

SHIPPED = ROOT / 'config' / 'weights'


@pytest.mark.parametrize(
    ('name', 'strategy', 'provenance'),
    [
        ('dt_iros', 'dt_iros', 'Set by hand'),
        ('dt_task', 'dt_task', 'Set by hand'),
        ('dt_task_env', 'dt_task_env', 'Learnt by train_weights from 3 recorded demonstrations'),
        ('dt_task_env_by_hand', 'dt_task_env', 'Set by hand'),
    ],
)
def test_shipped_weights(name, strategy, provenance):
    """They fit their strategy, have unit L1 norm, and say where they come from."""
    weights = read_weights(SHIPPED / f'{name}.yaml')
    make_strategy(strategy, weights.values)
    assert sum(abs(value) for value in weights.values.values()) == pytest.approx(1.0, abs=5e-6)
    assert provenance in weights.provenance


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('weights:\n  gain: 1e6', "line 2: 1e6 is a text in YAML 1.1 .*; write 1000000.0 or '1e6'"),
        ('weights: {gain: 1}\nreach: 0.5', "unknown member 'reach'; a weights file has weights, provenance, training"),
        ('weights: {discriminability: .nan}', 'must be a finite number, not nan'),
        ('weights: {discriminability: high}', "must be a finite number, not 'high'"),
        ('weights: {discriminability: true}', 'must be a finite number, not True'),
        ('weights: 3', 'no mapping "weights"'),
        ('weights: {}', 'no mapping "weights"'),
        ('- 1', 'expected a mapping'),
        ('weights: {a', 'not valid YAML'),
        (None, 'cannot be read'),
    ],
)
def test_files_that_are_no_weights(tmp_path, text, reason):
    path = tmp_path / 'weights.yaml'
    if text is not None:
        path.write_text(text)
    with pytest.raises(InputError, match=reason) as error:
        read_weights(path)
    assert '\n' not in str(error.value)


@pytest.mark.parametrize('name', ['dt_iros', 'dt_task', 'dt_task_env'])
def test_a_strategy_without_weights_says_how_to_load_them(name: str) -> None:
    """The message names the file that ships, for a user who makes the strategy in Python."""
    settings = EpisodeSettings(['cup', 'plate'], 10, 10, name)
    with pytest.raises(InputError, match=rf"weights=load_weights\('{name}'\)"):
        Episode(settings, random_stream(0, 'learner'))
    Episode(replace(settings, weights=load_weights(name)), random_stream(0, 'learner'))
    assert load_weights(name) == load_weights(str(SHIPPED / f'{name}.yaml'))


def test_unknown_weights_list_the_known() -> None:
    """Otherwise a slip in a strategy's name would be met with silence."""
    with pytest.raises(InputError, match=r"unknown weights 'dt_task_evn'; known: dt_iros, dt_task, dt_task_env"):
        load_weights('dt_task_evn')
