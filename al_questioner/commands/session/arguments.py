"""The command line of `session`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from al_questioner.support.arguments import Parser


def parser() -> Parser:
    """Make the parser of `session`."""
    result = Parser(
        prog='session',
        description="Show, check and export the log of a learner's session.",
        epilog='exit status: 0 the log is whole, 1 only what is before some damage can be used, 2 nothing can',
    )
    result.add_argument('folder', type=Path, metavar='DIR', help='the parameter `session` of the learner')
    result.add_argument('--json', type=Path, metavar='FILE', help='write the episode as JSON')
    result.add_argument('--csv', type=Path, metavar='DIR', help='write answers.csv and turns.csv')
    result.add_argument('--bag', type=Path, metavar='PATH', help='write the episode into a new bag')
    result.add_argument('--concepts', type=Path, metavar='FILE', help='write all that the learner knows')
    repair = 'keep what is before the damage, and the damaged files as broken-*'
    result.add_argument('--repair', action='store_true', help=repair)
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments."""
    return parser().parse_args(arguments)
