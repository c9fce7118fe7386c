"""From demonstrations to the document that is written."""

import dataclasses

import numpy as np
import pytest
import yaml

from al_questioner.commands.train_weights.pictures import draw_training
from al_questioner.domain import DECISION_FEATURES, InputError
from al_questioner.imitation.choice_likelihood import fit_choices
from al_questioner.imitation.demonstration import UnknownWorld, feature_scale
from al_questioner.imitation.settings import MatchingSettings, TrainingSettings
from al_questioner.imitation.training import check_alike, expected_gap, train, validation_text, weights_document
from al_questioner.questioning import FEATURE_SETS, make_strategy, read_weights
from al_questioner.questioning.strategies.value_per_cost import VALUE_FEATURES
from al_questioner.simulation import WorldSpec, episode_settings
from demonstrating import demonstrate
from shared.lunches import TASK, teacher_of

QUICK = MatchingSettings(iterations=3, rollouts=2)
BAGS = [{'name': 'a', 'sha256': '00'}, {'name': 'b', 'sha256': '11'}]


def written(folder, training, bags):
    path = folder / 'w.yaml'
    path.write_text(yaml.safe_dump(weights_document(training, len(bags), bags), sort_keys=False))
    return path


@pytest.mark.parametrize('method', ['maxent', 'choice'])
def test_what_is_written_can_be_read_and_tells_where_it_comes_from(experts, tmp_path, method):
    """Otherwise the learner could not take the weights, or nobody could tell what they are."""
    training = train(experts, TrainingSettings(method, matching=QUICK))
    path = written(tmp_path, training, BAGS)
    read = read_weights(path)
    assert list(read.values) == list(DECISION_FEATURES)
    assert sum(map(abs, read.values.values())) == pytest.approx(1, abs=1e-5)
    assert 'remaining_time' in read.provenance
    details = yaml.safe_load(path.read_text())['training']
    assert details['method'] == method
    assert details['bags'] == BAGS
    assert details['settings'].get('validation', 1) == 1
    assert details['softmax_scale'] == pytest.approx(training.scale, rel=1e-5) != 1.0
    assert details['gap_after'] != details['gap_before']
    assert set(details.get('validation_gap', ())) == ({'before', 'after', 'smallest'} if method == 'maxent' else set())
    assert details['unidentified'] == ['remaining_time']
    assert set(details['gap_before']) == set(details['gap_after']) == set(DECISION_FEATURES)
    assert draw_training(training, experts, [d.queries for d in experts], tmp_path / 'w.png').stat().st_size > 10_000


def test_it_is_said_whether_the_weights_hold_for_others(experts):
    """Otherwise a small gap where they were learnt would pass for success."""
    training = train(experts, TrainingSettings('maxent', matching=QUICK))
    gap = training.matching.iterations[0].validation_gap
    for share, fails in ((0.1, False), (1.5, True)):
        text = validation_text(training, dataclasses.replace(training.matching, validation_gap=share * gap))
        before = float(np.linalg.norm(gap))
        assert f'validation gap {before:.2f} before, {share * before:.2f} after' in text
        assert ('WARNING' in text) is fails
    alone = train(experts[:1], TrainingSettings('maxent', matching=QUICK))
    assert 'no demonstration was held out' in validation_text(alone, alone.matching)


def test_unweighted_choices_leave_no_gap_at_the_experts_steps(made):
    """At the maximum of the likelihood expected and chosen features are equal: equation 6, state by state."""
    shown = [made.synthetic(np.array([3, 1, -2, 0.5, -4, 0, -3.0]), 0, 100)]
    found = fit_choices(shown, importance=np.ones(100), ridge=0.0)
    assert np.abs(expected_gap(found, shown, feature_scale(shown))).max() < 1e-4
    assert np.abs(expected_gap(np.zeros(7), shown, feature_scale(shown))).max() > 0.1


def test_demonstrations_of_different_things_are_refused(experts, made):
    """Weights that are learnt from a mixture of strategies are those of no strategy."""
    first = experts[0]
    other_names = dataclasses.replace(first, name='b', feature_names=('size_x',))
    other_task = made.synthetic(np.ones(7), 0, 3)
    symbols = dataclasses.replace(first.settings, symbols=('cup', 'plate'))
    for other, reason in (
        (other_names, 'b was recorded with other features'),
        (other_task, 'is of task another world, expert prepare_lunch 0 of prepare_lunch'),
        (dataclasses.replace(first, name='c', settings=symbols), 'c is about cup, plate'),
    ):
        with pytest.raises(InputError, match=reason):
            check_alike([first, other])
    with pytest.raises(InputError, match='no demonstration'):
        check_alike([])


def test_demonstrations_of_an_unknown_task_are_alike_by_its_name_and_symbols(made):
    """Otherwise on a robot whose task is a file of its own nothing could be learnt, or from different tasks at once."""
    first = dataclasses.replace(made.synthetic(np.ones(7), 0, 30), world=UnknownWorld('table', "unknown task 'table'"))
    check_alike([first, dataclasses.replace(first, name='b', world=UnknownWorld('table', 'elsewhere'))])
    assert train([first, first], TrainingSettings('choice')).weights.any()
    symbols = dataclasses.replace(first.settings, symbols=('cup', 'plate'))
    for other, reason in (
        (dataclasses.replace(first, world=UnknownWorld('shelf', '')), 'is of task shelf, synthetic 0 of table'),
        (dataclasses.replace(first, settings=symbols), 'is about cup, plate'),
        (dataclasses.replace(first, world=None), 'is of task another world'),
    ):
        with pytest.raises(InputError, match=reason):
            check_alike([first, other])
    with pytest.raises(InputError, match=r"roll out in \(unknown task 'table'\); use --method choice"):
        train([first, first], TrainingSettings('maxent', matching=QUICK))


def test_objects_that_the_table_does_not_have_are_not_rolled_out_on_it(experts):
    """A robot's own objects under the name of a simulated task are not compared with a table nobody showed."""
    other = dataclasses.replace(experts[0], feature_names=('size_x',))
    with pytest.raises(InputError, match=r'other features than those of prepare_lunch.*use --method choice'):
        train([other], TrainingSettings('maxent', matching=QUICK))


@pytest.mark.parametrize('method', ['maxent', 'choice'])
def test_our_own_questioner_learns_from_the_same_expert(tmp_path, method):
    """It learns by its own features, from what the expert knew when it chose."""
    settings = episode_settings(TASK, 'expert', 6.0, 10, change_interval=5)
    feature_set = FEATURE_SETS['value_per_cost']
    shown = [demonstrate(WorldSpec(TASK, 0, 0), settings, teacher_of(TASK, 0), feature_set=feature_set)]
    assert shown[0].steps[0].features.shape[1] == len(VALUE_FEATURES)
    training = train(shown, TrainingSettings(method, 0, matching=QUICK))
    weights = read_weights(written(tmp_path, training, BAGS[:1])).values
    assert list(weights) == list(VALUE_FEATURES)
    make_strategy('value_per_cost', weights)
    if method == 'choice':
        assert weights['gain'] > 0, 'the expert asks for what is scarce'
    with pytest.raises(InputError, match='shows other features'):
        check_alike([shown[0], dataclasses.replace(shown[0], feature_set=FEATURE_SETS['dt_task_env'])])
