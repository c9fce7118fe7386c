"""The parameter files that ship must say what the nodes declare, value by value."""

from __future__ import annotations

import threading
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from al_questioner.domain import InputError, Setting
from al_questioner.protocol.learner import LearnerOptions
from al_questioner.ros.learner_episode import notes_on_known
from al_questioner.ros.node_arguments import help_text
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recorder import RecorderNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.parameters import checked
from al_questioner.ros.settings import (
    PERCEPTION_SETTINGS,
    RECOGNISER_SETTINGS,
    RECORDER_SETTINGS,
    TEACHER_SETTINGS,
    WORLD_SETTINGS,
    learner_settings,
)
from al_questioner.simulation import ScriptedTeacher, episode_settings, load_task
from al_questioner.support.configuration import config_dir, read_yaml
from shared.durable_sessions import WORLD

TASK = 'prepare_lunch'
FILES = sorted((config_dir() / 'params').glob('*.yaml'))


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.stem)
def test_file_lists_every_parameter_at_its_default(path: Path) -> None:
    """Otherwise a user would change a parameter that does not exist, or miss one that does."""
    content = read_yaml(path)
    task = load_task(path.stem)
    learner = learner_settings(task)
    settings = (
        *WORLD_SETTINGS,
        *PERCEPTION_SETTINGS,
        *TEACHER_SETTINGS,
        *RECOGNISER_SETTINGS,
        *RECORDER_SETTINGS,
        *learner,
    )
    # Of the sample depends what these are.
    left_out = {'sample'} if task.variety is None else {'sample', 'change_interval'}
    expected = {setting.name: setting.default for setting in settings if setting.name not in left_out}
    assert content == {'/**': {'ros__parameters': {**expected, 'task': path.stem}}}


def test_costs_of_a_task_are_the_learners_defaults(tmp_path: Path) -> None:
    """Otherwise a learner would ask at other prices than the demo of the same task."""
    path = tmp_path / 'mine.yaml'
    path.write_text('symbols: [cup, plate]\ncosts: {demonstration: 3, unknown: 0.5, unanswered: 1}\n')
    defaults = {setting.name: setting.default for setting in learner_settings(load_task(str(path)))}
    found = {name: value for name, value in defaults.items() if name.startswith(('cost_', 'charge_'))}
    assert found == {
        'cost_label': 1.0, 'cost_demonstration': 3.0, 'cost_feature_subset': 2.0, 'cost_relevance': 'never',
        'charge_unknown': 0.5, 'charge_skip': 1.0, 'charge_unanswered': 1.0,
    }  # fmt: skip


@pytest.mark.parametrize(('value', 'cost'), [('never', None), (3, 3.0), (0.5, 0.5)])
def test_a_node_takes_the_cost_of_a_relevance_query_or_never(graph: Any, value: object, cost: float | None) -> None:
    """A robot could not be told to ask which things matter, or not to."""
    learner = graph.start(LearnerNode, task='kitchen_table', cost_relevance=value)
    assert learner.machine._durable.started.settings.costs.relevance == cost


@pytest.mark.parametrize(
    'changes',
    [
        {'strategy': 'farthest_fsq', 'budget': 30.0, 'turns': 14, 'carry_labels': True},
        {'strategy': 'u_sampling', 'amplitude': 4.0, 'kernel_shape': 'rbf', 'class_balance': 0.25},
        {'length_scale': 3.0, 'change_interval': 7},
    ],
)
def test_the_episode_is_that_of_the_parameters(graph: Any, changes: dict[str, Any]) -> None:
    """Otherwise a parameter would do nothing: what a machine does with its settings is tried without a node."""
    started = graph.start(LearnerNode, **graph.episode | changes).machine._durable.started
    named = {'strategy': 'random_fsq', 'budget': 6.0, 'turns': 8} | changes
    assert started.settings == episode_settings(load_task(TASK), **named)
    assert started.settings != episode_settings(load_task(TASK), 'random_fsq', 6.0, 8)
    assert (started.seed, started.world['seed']) == (4, 4)


@pytest.mark.parametrize('yields', [False, True])
def test_the_learner_behaves_as_its_parameters_say(graph: Any, tmp_path: Path, yields: bool) -> None:
    """Otherwise it would not wait as long as it is told, or write elsewhere."""
    session, kept = tmp_path / 'session', tmp_path / 'kept.json'
    given = {'turn_period': 3.0, 'answer_timeout': 4.0, 'session': str(session), 'save_concepts': str(kept)}
    machine = graph.start(partial(LearnerNode, yields), **graph.episode, **given).machine
    files = [kept, session / 'concepts.json']
    assert machine._options == LearnerOptions(3.0, 4.0, yields, files, ('', ''), str(session))
    assert machine._world == WORLD


def test_perception_shows_the_frame_and_the_world_of_its_parameters(graph: Any) -> None:
    """Otherwise nobody could say where the objects are, or a learner of another world would see them."""
    machine = graph.start(PerceptionNode, **graph.world, frame_id='camera').machine
    assert (machine._frame_id, machine._world) == ('camera', WORLD)


def test_the_script_is_that_of_the_parameters(graph: Any) -> None:
    """Otherwise a teacher would never err, or think at once, whatever it is told."""
    errors = {'wrong_rate': 0.2, 'unknown_rate': 0.3, 'relevance_omission': 0.4, 'relevance_false_alarm': 0.5}
    given = {**errors, 'teacher_id': 'anna', 'repeat_shown': True}
    machine = graph.start(TeacherNode, **graph.world, **given, delay=2.5).machine
    task = load_task(TASK)
    assert machine._new_teacher() == ScriptedTeacher(task.symbols, task.relevant_groups, 4, **given)
    assert (machine._delay, machine._world) == (2.5, WORLD)


SHARE = Setting('share', 0.1, 'a share', lower=0.0, upper=1.0)
TOLERANCE = Setting('view_tolerance', 'auto', 'a change', lower=0.0, word='auto')


@pytest.mark.parametrize(
    ('setting', 'value', 'taken'),
    [
        *((SHARE, value, float(value)) for value in (1, 0.5, 0)),
        *((TOLERANCE, value, taken) for value, taken in (('auto', 'auto'), (1, 1.0), (0.5, 0.5))),
    ],
)
def test_integers_are_taken_for_floats_and_words_where_there_may_be_one(
    setting: Setting, value: object, taken: object
) -> None:
    """Otherwise `-p budget:=25` or `view_tolerance:=auto` would be refused."""
    assert checked(setting, value) == taken
    assert type(checked(setting, value)) is type(taken)


@pytest.mark.parametrize(
    ('setting', 'value', 'reason'),
    [(SHARE, value, 'parameter share') for value in (2, -0.1, float('nan'), '1')]
    + [(TOLERANCE, value, 'parameter view_tolerance') for value in ('automatic', -0.1, True)]
    + [
        (Setting('thing', default, 'a thing'), value, 'must be of type')
        for default, value in ((3, True), (3, 2.0), ('a', 3), (False, 1))
    ],
)
def test_other_values_are_refused(setting: Setting, value: object, reason: str) -> None:
    """Otherwise nonsense or a misspelt word would be taken, a truth value for a number, or a number for a name."""
    with pytest.raises(InputError, match=reason):
        checked(setting, value)


def test_help_names_every_parameter() -> None:
    """A user without the `ros2` command learns what can be set."""
    text = help_text('What it does.', learner_settings(load_task('prepare_lunch')))
    for setting in learner_settings(load_task('prepare_lunch')):
        assert f'  {setting.name} ' in text
    assert '[cost of a label query]' in text


def test_a_frame_without_a_name_is_refused(graph: Any) -> None:
    """Otherwise nobody could say where the objects are."""
    with pytest.raises(InputError, match='frame_id must not be empty'):
        graph.start(PerceptionNode, task=TASK, frame_id=' ')


def test_a_node_that_refuses_its_parameters_leaves_the_graph(graph: Any) -> None:
    """Otherwise its thread and its timers would stay in the process, and others would see a node that does nothing."""
    threads = threading.active_count()
    with pytest.raises(InputError, match='frame_id must not be empty'):
        graph.start(PerceptionNode, task=TASK, frame_id=' ')
    graph.wait_for(lambda: 'perception' not in graph.ears.get_node_names(), 'the node to leave')
    assert threading.active_count() == threads


def test_misspelt_parameters_are_refused(graph: Any) -> None:
    """Otherwise `-p bugdet:=20` would be ignored in silence."""
    for node in (LearnerNode, PerceptionNode, TeacherNode, RecorderNode):
        with pytest.raises(InputError, match=r'unknown parameter bugdet; known: '):
            graph.start(node, task=TASK, bugdet=20)


def test_a_file_of_an_earlier_version_that_never_tuned_is_taken(graph: Any, tmp_path: Path) -> None:
    """Otherwise every parameter file that somebody has copied would have to be changed, although nothing changes."""
    for node in (LearnerNode, PerceptionNode, TeacherNode, RecorderNode):
        graph.start(node, task=TASK, bag=str(tmp_path / 'bag'), tune_every=0)


@pytest.mark.parametrize(
    ('parameters', 'reason'),
    [
        ({'task': 'prepare_luch'}, 'unknown task'),
        ({'strategy': 'clever'}, 'unknown strategy'),
        ({'budget': -1.0}, 'budget must be 0 or more, not -1.0$'),
        ({'budget': float('nan')}, 'budget must be a finite number'),
        ({'budget': 'much'}, 'budget must be of type float'),
        ({'turns': 0}, 'turns must lie in'),
        ({'turns': 2.5}, 'turns must be of type int'),
        ({'seed': -3}, 'seed must be 0 or more, not -3'),
        ({'weights_file': '/no/such/file.yaml'}, 'no/such/file'),
        ({'amplitude': 0.0}, 'amplitude must lie in'),
        ({'length_scale': 1e200}, r'length_scale must lie in \[0, 1000\] standard deviations, not 1e\+200'),
        ({'length_scale': 1e-200}, r'length_scale must lie in \[0.001, 1000\] standard deviations, not 1e-200'),
        ({'budget': 1e308}, r'budget must lie in \[0, 1e\+12\], not 1e\+308'),
        ({'cost_label': 1e308}, r'parameter cost_label must lie in \[0, 1e\+12\], not 1e\+308'),
        ({'tune_every': 5}, 'parameter tune_every was removed: amplitude and length scale stay .*; leave it out$'),
    ],
)
def test_parameters_that_cannot_be_used_are_named(graph: Any, parameters: dict[str, Any], reason: str) -> None:
    """Otherwise an episode with other settings than those asked for would be played."""
    with pytest.raises(InputError, match=reason) as caught:
        graph.start(LearnerNode, **{**graph.episode, **parameters})
    assert '\n' not in str(caught.value)


def test_parameters_are_described_and_fixed(graph: Any) -> None:
    """Otherwise `ros2 param describe` would tell nothing, or a change in flight would be taken and ignored."""
    learner = graph.start(LearnerNode, **{**graph.episode, 'budget': 6})
    for name in ('budget', 'turns', 'strategy', 'turn_period', 'task', 'seed'):
        descriptor = learner.describe_parameter(name)
        assert descriptor.description
        assert descriptor.read_only
    budget = learner.describe_parameter('budget')
    assert budget.floating_point_range[0].from_value == 0.0
    assert 'cost of a label query' in budget.description
    assert learner.get_parameter('budget').value == 6.0


NODES = {
    'learner': (LearnerNode, learner_settings(load_task(TASK))),
    'perception': (PerceptionNode, PERCEPTION_SETTINGS),
    'teacher': (TeacherNode, TEACHER_SETTINGS),
    'recorder': (RecorderNode, RECORDER_SETTINGS),
}
ANOTHER: dict[type, list[Any]] = {
    bool: [True, False, 'maybe'],
    int: [3, -1, 2**63 - 1, 0.5],
    float: [1.0, -1.0, 3, float('nan'), float('inf'), float('-inf'), '1'],
    str: ['another', 7, ['a', 'b']],
}
"""Values to try on a parameter of each type: usable ones, and such that are not."""


@pytest.mark.parametrize('name', NODES)
def test_whatever_is_set_while_a_node_runs_is_refused_with_a_reason(graph: Any, tmp_path: Path, name: str) -> None:
    """Otherwise `ros2 param set` would be taken and ignored, or half of it taken, or NaN end the node."""
    make, own = NODES[name]
    settings = own if name == 'recorder' else (*WORLD_SETTINGS, *own)
    bag = {'bag': str(tmp_path / 'bag')} if name == 'recorder' else {'task': TASK}
    node = graph.start(make, **bag)
    before = {setting.name: node.get_parameter(setting.name).value for setting in settings}
    attempts = [
        Parameter(setting.name, value=value) for setting in settings for value in ANOTHER[type(setting.default)]
    ]
    attempts += [Parameter(setting.name, Parameter.Type.NOT_SET) for setting in settings]
    attempts += [Parameter('bugdet', value=3.0), Parameter('use_sim_time', value='perhaps')]
    service = graph.ears.create_client(SetParameters, f'{name}/set_parameters')
    graph.wait_for(service.service_is_ready, 'the parameter service')
    request = SetParameters.Request(parameters=[attempt.to_parameter_msg() for attempt in attempts])
    future = service.call_async(request)
    graph.wait_for(future.done, 'what becomes of the parameters')
    for attempt, result in zip(attempts, future.result().results, strict=True):
        assert not result.successful, attempt
        is_ours = attempt.name in before
        assert result.reason
        assert not is_ours or attempt.name in result.reason
        assert ('only read when the node starts' in result.reason) == is_ours
    together = [Parameter('use_sim_time', value=True), Parameter(settings[0].name, value=settings[0].default)]
    assert not node.set_parameters_atomically(together).successful
    assert node.get_parameter('use_sim_time').value is False
    assert {setting.name: node.get_parameter(setting.name).value for setting in settings} == before


@pytest.mark.parametrize(
    ('count', 'known', 'doubtful'),
    [
        (1, '1 example is known', 'mine: new, while 1 thing of none is known from before; if one is'),
        (
            2,
            '2 examples are known',
            'mine: new, while 2 things of none are known from before; if one is of that symbol',
        ),
    ],
)
def test_what_a_learner_begins_with_is_told_in_english(count: int, known: str, doubtful: str) -> None:
    """Otherwise it would say that 1 example are known."""
    concepts = SimpleNamespace(symbols=('snack',), counts={'none': count}, examples=[None] * count)
    settings: Any = SimpleNamespace(symbols=('snack', 'mine'), concepts=concepts)
    told, doubts = notes_on_known(settings)
    assert told == known
    assert doubts.startswith(doubtful)
