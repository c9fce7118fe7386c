"""Warnings about parameters that reach no node."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from al_questioner.ros.parameter_files import addresses, tell_what_has_no_effect, with_doubts


@pytest.mark.parametrize(
    ('pattern', 'taken'),
    [
        ('learner', ['/learner']),
        ('/learner', ['/learner']),
        ('robot/learner', ['/robot/learner']),
        ('/*/learner', ['/robot/learner']),
        ('/**/learner', ['/learner', '/robot/learner', '/a/b/learner']),
        ('*', ['/learner']),
        ('/**', ['/learner', '/robot/learner', '/a/b/learner']),
    ],
)
def test_names_in_files_stand_for_the_nodes_that_ros_takes_them_for(pattern: str, taken: list[str]) -> None:
    """Parameters that have an effect are not said to have none: these are the names that rclpy took, tried out."""
    assert [name for name in ('/learner', '/robot/learner', '/a/b/learner') if addresses(pattern, name)] == taken


def said_to(name: str, arguments: list[str], **overrides: Any) -> list[tuple[str, str]]:
    """Return the log lines of a node of this name, which declares no parameter."""
    said: list[tuple[str, str]] = []
    logger = SimpleNamespace(**{level: partial(lambda *one: said.append(one), level) for level in ('info', 'warning')})
    node = SimpleNamespace(
        get_logger=lambda: logger,
        get_name=lambda: name.rsplit('/', 1)[-1],
        get_fully_qualified_name=lambda: name,
        has_parameter=lambda _: False,
        _parameter_overrides={key: SimpleNamespace(value=value) for key, value in overrides.items()},
    )
    tell_what_has_no_effect(node, arguments)
    return said


@pytest.mark.parametrize(
    ('content', 'level', 'names'),
    [
        ({'lerner': {}}, 'warning', '/lerner'),
        ({'learner': {}}, 'warning', '/learner'),
        ({'/left/learner': {}}, 'warning', '/left/learner'),
        ({'left': {'learner': {}, 'teacher': {}}}, 'warning', '/left/learner, /left/teacher'),
        ({'/**': {}, 'learner': {}, 'teacher': {}}, 'warning', '/learner'),
        ({'teacher': {}, '/robot/perception': {}}, 'info', '/teacher, /robot/perception'),
        ({'/robot/learner': {}, '/left/learner': {}}, None, ''),
        ({'/**/learner': {}, 'teacher': {}}, None, ''),
        ({'robot': {'learner': {}}}, None, ''),
        ({}, None, ''),
    ],
)
def test_a_file_for_others_is_named(tmp_path: Path, content: dict[str, Any], level: str | None, names: str) -> None:
    """Otherwise a misspelt node, or one in another namespace, would run at its defaults, and nobody know why."""

    def with_values(below: dict[str, Any]) -> dict[str, Any]:
        return {
            key: with_values(value) if value else {'ros__parameters': {'budget': 3.0}} for key, value in below.items()
        }

    file = tmp_path / 'params.yaml'
    file.write_text(yaml.safe_dump(with_values(content), sort_keys=False))
    expected = f'{file} sets parameters of {names}: this node is /robot/learner and takes none of these'
    assert said_to('/robot/learner', ['--ros-args', '--params-file', str(file)]) == (
        [(level, expected)] if level else []
    )


def test_parameters_and_overrides_for_others_are_named() -> None:
    """Otherwise `-p lerner:budget:=3` would be ignored in silence, and so an override that the node lacks."""
    arguments = ['--ros-args', '-p', 'lerner:budget:=3', '-p', 'budget:=3', '-p', 'learner:text:=a:b']
    override = 'qos_overrides./objects.publisher.depth'
    assert said_to('/learner', [*arguments, '--', '-p', 'x:y:=1'], **{override: 3}) == [
        ('warning', '-p lerner:budget:=3 sets parameters of /lerner: this node is /learner and takes none of these'),
        ('warning', f'parameter {override} has no effect on /learner, which has no such end'),
    ]


@pytest.mark.parametrize('arguments', [[], ['--ros-args'], ['--ros-args', '-p'], ['--ros-args', '--params-file']])
def test_a_node_without_parameters_is_told_nothing(arguments: list[str]) -> None:
    """The nodes of a demo in one process have no arguments at all."""
    assert said_to('/learner', arguments) == []


def test_a_process_tells_it(processes: Any, tmp_path: Path) -> None:
    """Otherwise nobody would see it."""
    file = tmp_path / 'params.yaml'
    file.write_text('percepton:\n  ros__parameters:\n    seed: 3\n')
    command = [sys.executable, '-m', 'al_questioner', 'perception', '--ros-args', '--params-file', str(file)]
    processes.start('perception', command)
    processes.wait_for_log('perception', f'{file} sets parameters of /percepton: this node is /perception')


@pytest.mark.parametrize('content', ['budget: 5.0\n    budget: 9.0', 'seed: 010'])
def test_a_file_that_can_be_read_in_two_ways_is_told_of(tmp_path: Path, content: str) -> None:
    """Otherwise the last of two equal keys would win in silence."""
    path = tmp_path / 'params.yaml'
    path.write_text(f'/learner:\n  ros__parameters:\n    {content}\n')
    (said,) = said_to('/learner', ['--ros-args', '--params-file', str(path)])
    assert said[0] == 'warning'
    assert f'{path}, line ' in said[1]


def test_a_doubtful_file_is_read_for_its_names_all_the_same(tmp_path: Path) -> None:
    """Otherwise a misspelt node would be named only once every other line is correct."""
    path = tmp_path / 'params.yaml'
    path.write_text('lerner:\n  ros__parameters:\n    seed: 010\n    session: y\n')
    said = said_to('/learner', ['--ros-args', '--params-file', str(path)])
    assert [line.removeprefix(str(path))[:8] for _, line in said] == [', line 3', ', line 4', ' sets pa']


def test_a_refused_value_comes_with_the_line_that_ros_took_otherwise(tmp_path: Path) -> None:
    """Otherwise `strategy: no` would be refused as False, which nobody wrote."""
    path, other = tmp_path / 'params.yaml', tmp_path / 'other.yaml'
    path.write_text('learner:\n  ros__parameters:\n    turns: 3\n    turns: 4\n    strategy: no\n')
    other.write_text('learner:\n  ros__parameters:\n    turns: 3\n')
    arguments = ['--ros-args', '--params-file', str(path), '--params-file', str(other)]
    assert with_doubts('refused', arguments) == (
        f"refused; {path}, line 4: key 'turns' occurs twice, first in line 3;"
        f" {path}, line 5: no is a truth value in YAML 1.1 and a text in YAML 1.2; write false or 'no'"
    )
    assert with_doubts('refused', ['--ros-args', '--params-file', str(other), '-p', 'a:=no']) == 'refused'


@pytest.mark.parametrize(
    ('line', 'refused'),
    [
        ('strategy: no', 'parameter strategy must be of type str, not False; '),
        ('budget: 1_0.5', "parameter budget must be of type float, not '1_0.5'; "),
        ('symbols: [cup, no]', 'unusable ROS arguments: '),
        ('session: y', 'parameter session must be of type str, not True; '),
    ],
)
def test_a_node_names_the_line_of_what_it_refuses(tmp_path: Path, refusal: Any, line: str, refused: str) -> None:
    """The user need not guess which of ten lines of parameters is meant."""
    path = tmp_path / 'params.yaml'
    path.write_text(f'learner:\n  ros__parameters:\n    turns: 3\n    {line}\n    turns: 3\n')
    error = refusal('learner', '--ros-args', '--params-file', path)
    assert error.startswith(f'learner: {refused}')
    assert f'{path}, line 4: ' in error
    assert f"{path}, line 5: key 'turns' occurs twice" in error


@pytest.mark.parametrize(('content', 'found'), [('', 'nothing'), ('# later', 'nothing'), ('seed', 'str')])
def test_a_file_without_parameters_is_refused(tmp_path: Path, refusal: Any, content: str, found: str) -> None:
    """Otherwise the node would run at its defaults: ROS takes such a file for one that sets nothing."""
    path = tmp_path / 'params.yaml'
    path.write_text(content)
    error = refusal('perception', '--ros-args', '--params-file', path)
    assert error == f'perception: {path}: expected a mapping of settings, found {found}'
