"""The command line of `replay`; no ROS is needed to refuse it, or to show its help."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from al_questioner.domain import InputError
from al_questioner.support.arguments import NumberWithin, Parser
from al_questioner.support.configuration import named_bag

KEYS = 'space: pause · right or n: a turn · s: a message · up, down: rate · q: quit'
"""Help for the keys of `replay`."""


def parser() -> Parser:
    """Make the parser of `replay`; ROS arguments may follow."""
    result = Parser(
        prog='replay',
        description='Play a bag on the topics it was recorded from, with its timing.',
        epilog=f'In a terminal: {KEYS}. ROS arguments may follow: --ros-args -r __ns:=/elsewhere',
    )
    bag_help = 'directory of the bag, or the name of one that ships, such as expert_0'
    result.add_argument('bag', metavar='BAG', help=bag_help)
    result.add_argument('--rate', type=float, default=1.0, help='recorded seconds in a second (%(default)s)')
    result.add_argument('--loop', action='store_true', help='start again from the beginning at the end')
    clock_help = 'rate at which the recorded time is published on /clock (0: not at all)'
    result.add_argument('--clock', type=NumberWithin(float, 0, 1000), default=0.0, metavar='HZ', help=clock_help)
    result.add_argument('--start-paused', action='store_true', help='begin with a pause')
    wait_help = 'begin when somebody listens, or after this time (%(default)s)'
    result.add_argument(
        '--wait-for-subscribers', type=NumberWithin(float, 0, 3600), default=5.0, metavar='SECONDS', help=wait_help
    )
    perception_help = 'stand in for perception: show the scene of turn N when a live learner begins its turn N'
    result.add_argument('--as-perception', action='store_true', help=perception_help)
    check_help = 'do not play: tell whether the recorded scenes and answers give the recorded decisions; needs no ROS'
    result.add_argument('--check', action='store_true', help=check_help)
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments; `ros` holds the ROS arguments.

    Raises:
        InputError: an option that means nothing beside another one, or there is no such bag.
    """
    at = arguments.index('--ros-args') if '--ros-args' in arguments else len(arguments)
    own = parser()
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
