"""The launch file starts three nodes as the user asked; `launch` is not on PyPI, so stand-ins record the calls."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from shared.checkout import ROOT

DEFAULTS = {'end_with_learner': 'false', 'perception': 'simulated', 'teacher': 'scripted', 'task': 'kitchen_table'}
DEFAULTS |= {'recognise': 'false', 'show': 'none'}
OPTIONAL = ('namespace', 'params_file', 'bag', 'use_sim_time', 'dataset', 'seed', 'strategy', 'budget', 'turns')
OPTIONAL += ('turn_period', 'session', 'concepts', 'save_concepts')


class Recorded(SimpleNamespace):
    """Any of launch's actions: keeps what it was made of."""

    def __init__(self, *positional: Any, **named: Any) -> None:
        super().__init__(positional=positional, **named)


@pytest.fixture
def load(monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[Recorded]]:
    """A function that gives the entities that the launch file describes."""
    names = {
        'launch': ('LaunchContext', 'LaunchDescription'),
        'launch.events': (),
        'launch.events.process': ('ProcessExited',),
        'launch.actions': ('DeclareLaunchArgument', 'OpaqueFunction', 'Shutdown'),
        'launch_ros': (),
        'launch_ros.actions': ('Node',),
        'ament_index_python': (),
        'ament_index_python.packages': (),
    }
    for module_name, classes in names.items():
        module = ModuleType(module_name)
        vars(module).update({name: type(name, (Recorded,), {}) for name in classes})
        monkeypatch.setitem(sys.modules, module_name, module)
    vars(module)['PackageNotFoundError'] = KeyError
    installed = {'al_questioner': str(ROOT), 'rviz2': '/opt/rviz2', 'tf2_ros': '/opt/tf2_ros'}
    vars(module)['get_package_share_directory'] = installed.__getitem__
    path = str(ROOT / 'launch' / 'demo.launch.py')
    return lambda: runpy.run_path(path)['generate_launch_description']().positional[0]


@pytest.fixture
def description(load: Callable[[], list[Recorded]]) -> list[Recorded]:
    """The entities that the launch file describes where another one includes it."""
    return load()


def started(description: list[Recorded], **arguments: str) -> dict[str, Recorded]:
    """The nodes by executable, for the arguments of a `ros2 launch` command."""
    declared = {entity.positional[0]: entity.default_value for entity in description[:-1]}
    assert arguments.keys() <= declared.keys()
    context = SimpleNamespace(launch_configurations=declared | arguments)
    return {node.executable: node for node in description[-1].function(context)}


def test_every_argument_is_declared_with_a_description(description):
    defaults = {entity.positional[0]: entity.default_value for entity in description[:-1]}
    assert defaults == {**DEFAULTS, **dict.fromkeys(OPTIONAL, '')}
    assert all(entity.description for entity in description[:-1])


def test_three_nodes_of_this_package_read_the_parameters_of_the_task(description):
    nodes = started(description, task='prepare_lunch')
    assert nodes.keys() == {'perception', 'learner', 'teacher'}
    for node in nodes.values():
        file, given = node.parameters
        assert node.package == 'al_questioner'
        assert Path(file) == ROOT / 'config' / 'params' / 'prepare_lunch.yaml'
        assert given == {'task': 'prepare_lunch'}


def test_arguments_reach_the_nodes_that_declare_them_in_the_type_they_declare(description):
    world = {'task': 'tabletop', 'dataset': '/crops', 'seed': 3}
    learner = {'strategy': 'dt_iros', 'budget': 15.0, 'turns': 20, 'turn_period': 0.5}
    nodes = started(description, **{name: str(value) for name, value in (world | learner | {'budget': 15}).items()})
    assert nodes['perception'].parameters[-1] == nodes['teacher'].parameters[-1] == world
    given = nodes['learner'].parameters[-1]
    assert given == world | learner
    assert type(given['budget']) is float, 'the node declares a double; an integer would be another type'


def test_nodes_bear_name_and_namespace(description):
    """Without both, launch writes arguments under a wildcard, and the file's entries for one node prevail over them."""
    for name, node in started(description, namespace='/robot_1').items():
        assert (node.name, node.namespace) == (name, '/robot_1')


@pytest.mark.parametrize(
    ('arguments', 'executables'),
    [
        ({}, {'perception', 'teacher', 'learner'}),
        ({'teacher': 'none'}, {'perception', 'learner'}),
        ({'teacher': 'none', 'perception': 'none'}, {'learner'}),
        ({'bag': '/tmp/bag'}, {'record', 'perception', 'teacher', 'learner'}),
    ],
)
def test_a_robot_brings_eyes_teacher_and_recorder_of_its_own(description, arguments, executables):
    """Otherwise two nodes would show objects, or answer, on the same topics."""
    assert started(description, **arguments).keys() == executables


def test_a_recogniser_follows_the_learner(description):
    """The learner's file, or its log of another day, would be all that it knows otherwise."""
    arguments = {'concepts': 'known.json', 'session': 'log', 'use_sim_time': 'true', 'seed': '3'}
    nodes = started(description, recognise='true', namespace='/robot_1', **arguments)
    assert nodes.keys() == {'perception', 'teacher', 'learner', 'recognise'}
    recogniser = nodes['recognise']
    assert (recogniser.name, recogniser.namespace) == ('recogniser', '/robot_1')
    assert recogniser.parameters[-1] == {'concepts': '', 'session': '', 'use_sim_time': True}
    assert nodes['learner'].parameters[-1]['concepts'] == 'known.json'


def test_rviz_shows_the_table_in_the_world(description):
    """Without a transform RViz complains of a frame that does not exist."""
    nodes = started(description, show='rviz', namespace='/robot_1')
    rviz, transform = nodes['rviz2'], nodes['static_transform_publisher']
    assert (rviz.package, rviz.namespace) == ('rviz2', '/robot_1')
    assert rviz.arguments == ['-d', str(ROOT / 'config' / 'rviz' / 'al_questioner.rviz')]
    assert ('/scene_markers', 'scene_markers') in rviz.remappings
    assert transform.package == 'tf2_ros'
    assert transform.arguments == ['--frame-id', 'world', '--child-frame-id', 'table']
    assert 'static_transform_publisher' not in started(description, show='rviz', perception='none')


def test_all_wait_for_the_recorder(description):
    """Otherwise the bag would lack the first turns, and be of no use as a demonstration."""
    nodes = started(description, bag='/tmp/bag', seed='3')
    recorder = nodes.pop('record')
    assert (recorder.name, recorder.parameters[-1]) == ('recorder', {'bag': '/tmp/bag'})
    assert all(node.parameters[-1]['wait_for_recorder'] is True for node in nodes.values())


def test_the_users_file_takes_the_place_of_the_tasks(description, tmp_path):
    (tmp_path / 'mine.yaml').write_text('/**: {ros__parameters: {budget: 3.0}}')
    for node in started(description, params_file=str(tmp_path / 'mine.yaml'), bag='/tmp/bag').values():
        assert node.parameters[:-1] == [str(tmp_path / 'mine.yaml')]


@pytest.mark.parametrize(('text', 'value'), [('true', True), ('False', False), ('1', True)])
def test_simulated_time_is_for_all(description, text, value):
    for node in started(description, use_sim_time=text, bag='/tmp/bag').values():
        assert node.parameters[-1]['use_sim_time'] is value
    for node in started(description, bag='/tmp/bag').values():
        assert 'use_sim_time' not in node.parameters[-1], 'it would override what an outer launch file sets'


@pytest.mark.parametrize(
    ('arguments', 'ends', 'status', 'failures', 'has_ended'),
    [
        (['demo.launch.py'], 'default', 0, 0, True),
        (['demo.launch.py'], 'default', 2, 1, True),
        (['robot.launch.py'], 'default', 0, 0, False),
        (['robot.launch.py'], 'default', 2, 1, False),
        (['robot.launch.py'], 'true', 2, 1, True),
        (['demo.launch.py'], 'false', 2, 1, False),
    ],
)
def test_the_learners_end_is_that_of_all_only_where_this_file_is_what_was_launched(
    load, monkeypatch, arguments, ends, status, failures, has_ended
):
    """Otherwise a robot would be switched off with the learner, or a script not see that it failed."""
    monkeypatch.setattr(sys, 'argv', ['ros2', 'launch', 'al_questioner', *arguments])
    nodes = started(load(), **({} if ends == 'default' else {'end_with_learner': ends}))
    assert [name for name, node in nodes.items() if hasattr(node, 'on_exit')] == ['learner']
    told: list[dict[str, str]] = []
    loop = SimpleNamespace(call_exception_handler=told.append)
    running, ending = (SimpleNamespace(asyncio_loop=loop, is_shutdown=each) for each in (False, True))
    result = nodes['learner'].on_exit(SimpleNamespace(returncode=status), running)
    assert type(result).__name__ == ('Shutdown' if has_ended else 'NoneType')
    # That is how launch is told of a failure that is to show in its status: see `LaunchService.run_async`.
    assert [each['message'] for each in told] == [f'the learner has ended with status {status}'] * failures
    nodes['learner'].on_exit(SimpleNamespace(returncode=-9), ending)
    assert len(told) == failures, 'what launch itself has ended has not failed'


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        ({'teacher': 'terminal'}, "launch argument teacher must be one of scripted, none, not 'terminal'"),
        ({'use_sim_time': 'maybe'}, "launch argument use_sim_time must be one of .*, not 'maybe'"),
        ({'end_with_learner': ''}, "launch argument end_with_learner must be one of .*, not ''"),
        ({'params_file': '/no/such.yaml'}, "launch argument params_file: '/no/such.yaml' is no file"),
        ({'show': 'tv'}, "launch argument show must be one of none, rviz, foxglove, not 'tv'"),
        ({'show': 'foxglove'}, 'launch argument show: the package foxglove_bridge is not installed'),
        ({'recognise': 'maybe'}, "launch argument recognise must be one of .*, not 'maybe'"),
        ({'turns': 'many'}, "launch argument turns must be of type int, not 'many'"),
    ],
)
def test_unusable_arguments_are_named(description, arguments, reason):
    """Otherwise launch would warn of a file that is missing, and start all without it."""
    with pytest.raises(ValueError, match=reason):
        started(description, **arguments)


def test_a_task_without_parameter_file_is_started_with_the_arguments_alone(description):
    arguments = {'task': '/home/me/workshop.yaml'}
    assert started(description, **arguments)['learner'].parameters == [arguments]
