"""The command lines of the executables that run as nodes; no ROS is needed to refuse them, or to show their help."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from al_questioner.domain import InputError
from al_questioner.ros.settings import (
    PERCEPTION_SETTINGS,
    RECOGNISER_SETTINGS,
    TEACHER_SETTINGS,
    WORLD_SETTINGS,
    Settings,
    learner_settings,
)
from al_questioner.simulation import load_task
from al_questioner.simulation.world_spec import TASK

PERCEPTION = 'The perception node: looks at the simulated table whenever the learner begins a turn.'
LEARNER = 'The learner node: an Episode between the topics of the robot and of the teacher.'
TEACHER = """The teacher node: answers the learner's queries, from a script or by a person at this process's terminal.

mode:=scripted answers with the truth of the simulated world; mode:=terminal shows each question to you."""

RECOGNISER = """The recogniser node: tells what the things in view are taken for, and where the wanted one is.

Without `concepts` and `session` it follows a learner on the topic `concepts`."""


def perception(arguments: Sequence[str]) -> list[str]:
    """Read the ROS arguments of the perception node."""
    return read_node_arguments(arguments, PERCEPTION, (*WORLD_SETTINGS, *PERCEPTION_SETTINGS))


def learner(arguments: Sequence[str]) -> list[str]:
    """Read the ROS arguments of the learner node."""
    return read_node_arguments(arguments, LEARNER, (*WORLD_SETTINGS, *learner_settings(load_task(TASK.default))))


def teacher(arguments: Sequence[str]) -> list[str]:
    """Read the ROS arguments of the teacher node."""
    return read_node_arguments(arguments, TEACHER, (*WORLD_SETTINGS, *TEACHER_SETTINGS))


def recogniser(arguments: Sequence[str]) -> list[str]:
    """Read the ROS arguments of the recogniser node."""
    return read_node_arguments(arguments, RECOGNISER, RECOGNISER_SETTINGS)


def help_text(description: str, settings: Settings) -> str:
    """Return what `--help` of a node prints: what it does, and its parameters with their defaults."""
    width = max(len(setting.name) for setting in settings)
    lines = (f'  {each.name:<{width}}  {each.described} (default {json.dumps(each.default)})' for each in settings)
    return '\n'.join([description, '', 'parameters (--ros-args -p NAME:=VALUE):', *lines])


def check_ros_arguments(arguments: Sequence[str]) -> None:
    """See that there is nothing but what ROS reads: all from `--ros-args` to the end, or to `--`.

    Raises:
        InputError: an argument that nobody would read.
    """
    for stray in _others(arguments):
        raise InputError(f'unexpected argument {stray!r}; parameters are given as --ros-args -p NAME:=VALUE')


def read_node_arguments(arguments: Sequence[str], description: str, settings: Settings) -> list[str]:
    """Read the ROS arguments of a node; print its help if that is asked for.

    Raises:
        InputError: an argument that nobody would read.
        SystemExit: after the help.
    """
    if any(argument in ('-h', '--help') for argument in arguments):
        print(help_text(description, settings))
        raise SystemExit(0)
    check_ros_arguments(arguments)
    return list(arguments)


def _others(arguments: Sequence[str]) -> Iterator[str]:
    is_ros = False
    for argument in arguments:
        if is_ros:
            is_ros = argument != '--'
        elif argument == '--ros-args':
            is_ros = True
        else:
            yield argument
