"""The launch file starts three nodes as the user asked; `launch` is not on PyPI, so stand-ins record the calls."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
OPTIONAL = ('dataset', 'seed', 'strategy', 'budget', 'turns', 'turn_period', 'session')


class Recorded(SimpleNamespace):
    """Any of launch's actions: keeps what it was made of."""

    def __init__(self, *positional: Any, **named: Any) -> None:
        super().__init__(positional=positional, **named)


@pytest.fixture
def description(monkeypatch: pytest.MonkeyPatch) -> list[Recorded]:
    """The entities that the launch file describes."""
    names = {
        'launch': ('LaunchContext', 'LaunchDescription'),
        'launch.actions': ('DeclareLaunchArgument', 'OpaqueFunction', 'Shutdown'),
        'launch_ros': (),
        'launch_ros.actions': ('Node',),
        'ament_index_python': (),
        'ament_index_python.packages': (),
    }
    for module_name, classes in names.items():
        module = ModuleType(module_name)
        for name in classes:
            setattr(module, name, type(name, (Recorded,), {}))
        monkeypatch.setitem(sys.modules, module_name, module)
    monkeypatch.setattr(
        sys.modules['ament_index_python.packages'],
        'get_package_share_directory',
        lambda _: str(CHECKOUT),
        raising=False,
    )
    return runpy.run_path(str(CHECKOUT / 'launch' / 'demo.launch.py'))['generate_launch_description']().positional[0]


def started(description: list[Recorded], **arguments: str) -> dict[str, Recorded]:
    """The nodes by executable, for the arguments of a `ros2 launch` command."""
    declared = {entity.positional[0]: entity.default_value for entity in description[:-1]}
    assert arguments.keys() <= declared.keys()
    context = SimpleNamespace(launch_configurations=declared | arguments)
    return {node.executable: node for node in description[-1].function(context)}


def test_every_argument_is_declared_with_a_description(description):
    assert {entity.positional[0] for entity in description[:-1]} == {'task', 'namespace', *OPTIONAL}
    assert all(entity.description for entity in description[:-1])


def test_three_nodes_of_this_package_read_the_parameters_of_the_task(description):
    nodes = started(description, task='prepare_lunch')
    assert nodes.keys() == {'perception', 'learner', 'teacher'}
    for node in nodes.values():
        file, given = node.parameters
        assert node.package == 'al_questioner'
        assert Path(file) == CHECKOUT / 'config' / 'params' / 'prepare_lunch.yaml'
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


def test_a_task_without_parameter_file_is_started_with_the_arguments_alone(description):
    assert started(description, task='/home/me/workshop.yaml')['learner'].parameters == [
        {'task': '/home/me/workshop.yaml'}
    ]


def test_a_number_that_is_none_is_named(description):
    with pytest.raises(ValueError, match="launch argument turns must be of type int, not 'many'"):
        started(description, turns='many')
