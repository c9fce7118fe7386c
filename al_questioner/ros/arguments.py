"""The command lines of the executables that run as nodes; no ROS is needed to refuse them, or to show their help."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence

from al_questioner.arguments import Parser, number
from al_questioner.configuration import named_bag
from al_questioner.domain import InputError
from al_questioner.ros.setting import Setting, help_text
from al_questioner.ros.settings import (
    DEFAULT_TASK,
    PERCEPTION_SETTINGS,
    RECORDER_SETTINGS,
    TEACHER_SETTINGS,
    WORLD_SETTINGS,
    learner_settings,
)
from al_questioner.world import load_task

PERCEPTION = 'The perception node: looks at the simulated table whenever the learner begins a turn.'
LEARNER = 'The learner node: an Episode between the topics of the robot and of the teacher.'
TEACHER = """The teacher node: answers the learner's queries, from a script or by a person at this process's terminal.

mode:=scripted answers with the truth of the simulated world; mode:=terminal shows each question to you."""
RECORD = """Records the topics of learning episodes into a bag, or makes one whole whose recording was killed.

usage: record --ros-args -p bag:=PATH ...
       record --repair BAG"""
KEYS = 'space: pause · right or n: a turn · s: a message · up, down: rate · q: quit'
"""Of `replay`."""


def perception(arguments: Sequence[str]) -> list[str]:
    """The ROS arguments of the perception node."""
    return _of_node(arguments, PERCEPTION, (*WORLD_SETTINGS, *PERCEPTION_SETTINGS))


def learner(arguments: Sequence[str]) -> list[str]:
    """The ROS arguments of the learner node."""
    return _of_node(arguments, LEARNER, (*WORLD_SETTINGS, *learner_settings(load_task(DEFAULT_TASK))))


def teacher(arguments: Sequence[str]) -> list[str]:
    """The ROS arguments of the teacher node."""
    return _of_node(arguments, TEACHER, (*WORLD_SETTINGS, *TEACHER_SETTINGS))


def record(arguments: Sequence[str]) -> argparse.Namespace:
    """As `repair` the bag to make whole, or None, and as `ros` the ROS arguments of the recorder."""
    if arguments and arguments[0] == '--repair':
        if len(arguments) != 2:
            raise InputError(f'--repair takes one bag, not {len(arguments) - 1}')
        return argparse.Namespace(repair=named_bag(arguments[1]))
    return argparse.Namespace(repair=None, ros=_of_node(arguments, RECORD, RECORDER_SETTINGS))


def replay_parser() -> Parser:
    """The arguments of `replay`; ROS arguments may follow."""
    result = Parser(
        prog='replay',
        description='Play a bag on the topics it was recorded from, with its timing.',
        epilog=f'In a terminal: {KEYS}. ROS arguments may follow: --ros-args -r __ns:=/elsewhere',
    )
    bag_help = 'directory of the bag, or the name of one that ships, such as expert_0'
    result.add_argument('bag', metavar='BAG', help=bag_help)
    result.add_argument('--rate', type=float, default=1.0, help='recorded seconds in a second (%(default)s)')
    result.add_argument('--loop', action='store_true', help='begin anew at the end')
    clock_help = 'publish the recorded time on /clock so often (0: not at all)'
    result.add_argument('--clock', type=number(float, 0, 1000), default=0.0, metavar='HZ', help=clock_help)
    result.add_argument('--start-paused', action='store_true', help='begin with a pause')
    wait_help = 'begin when somebody listens, or after so many seconds (%(default)s)'
    result.add_argument(
        '--wait-for-subscribers', type=number(float, 0, 3600), default=5.0, metavar='SECONDS', help=wait_help
    )
    perception_help = 'stand in for perception: show the scene of turn N when a live learner begins its turn N'
    result.add_argument('--as-perception', action='store_true', help=perception_help)
    check_help = 'do not play: tell whether the recorded scenes and answers give the recorded decisions; needs no ROS'
    result.add_argument('--check', action='store_true', help=check_help)
    return result


def replay(arguments: Sequence[str]) -> argparse.Namespace:
    """What the arguments ask for, and as `ros` the ROS arguments.

    Raises:
        InputError: an option that means nothing beside another one, or there is no such bag.
    """
    at = arguments.index('--ros-args') if '--ros-args' in arguments else len(arguments)
    own = replay_parser()
    given = own.parse_args(arguments[:at])
    given.ros = list(arguments[at:])
    if given.check or given.as_perception:
        mode = '--check' if given.check else '--as-perception'
        for name in (*_TIMING, 'as_perception') if given.check else _TIMING:
            if getattr(given, name) != own.get_default(name):
                raise InputError(f'--{name.replace("_", "-")} has no meaning together with {mode}')
    given.bag = named_bag(given.bag)
    return given


_TIMING = ('rate', 'loop', 'clock', 'start_paused', 'wait_for_subscribers')


def check_ros_arguments(arguments: Sequence[str]) -> None:
    """See that there is nothing but what ROS reads: all from `--ros-args` to the end, or to `--`.

    Raises:
        InputError: an argument that nobody would read.
    """
    for stray in _others(arguments):
        raise InputError(f'unexpected argument {stray!r}; parameters are given as --ros-args -p NAME:=VALUE')


def _of_node(arguments: Sequence[str], description: str, settings: Sequence[Setting]) -> list[str]:
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
