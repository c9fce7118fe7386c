"""The command line of `train_weights`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain import CLASSIFIERS, InputError
from al_questioner.imitation.settings import ITERATIONS, METHOD, PATIENCE, RIDGE, ROLLOUTS, VALIDATION
from al_questioner.questioning import FEATURE_SETS
from al_questioner.simulation.world_spec import SEED
from al_questioner.support.arguments import JOBS, Parser, add_option
from al_questioner.support.configuration import named_bag

FORMATS = ('.png', '.pdf', '.svg')
"""Formats of the picture."""


def parser() -> Parser:
    """Make the parser of `train_weights`."""
    result = Parser(prog='train_weights', description="Learn a strategy's weights from an expert's recorded episodes.")
    bags_help = 'a bag of the `record` executable, or the name of one that ships, such as expert_0'
    result.add_argument('bags', nargs='+', metavar='BAG', help=bags_help)
    result.add_argument('--out', type=Path, required=True, metavar='FILE', help='the YAML file to write')
    strategy_help = 'whose weights are learnt (%(default)s)'
    result.add_argument('--strategy', choices=tuple(FEATURE_SETS), default='dt_task_env', help=strategy_help)
    add_option(result, METHOD, help=METHOD.description)
    add_option(result, SEED, help='of the rollouts (%(default)s)')
    for setting in (ITERATIONS, PATIENCE, ROLLOUTS, VALIDATION, RIDGE):
        add_option(result, setting)
    for setting in CLASSIFIERS.values():
        add_option(result, setting, 'as recorded')
    add_option(result, JOBS, default=None, help='processes of maxent (one for each processor)')
    result.add_argument('--picture', type=Path, metavar='FILE', help='(the name of --out, ending in .png)')
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments; `classifiers` holds what of the classifiers is not to be as recorded.

    Raises:
        InputError: the picture has no name that it can have, or there is no such bag.
    """
    given = parser().parse_args(arguments)
    given.bags = [named_bag(bag) for bag in given.bags]
    given.classifiers = {name: value for name in CLASSIFIERS if (value := getattr(given, name)) is not None}
    given.jobs = given.jobs or os.cpu_count() or 1
    given.picture = given.picture or given.out.with_suffix('.png')
    if given.picture.resolve() == given.out.resolve():
        raise InputError(f'{given.picture} cannot be the weights and the picture: name one of them otherwise')
    if given.picture.suffix not in FORMATS:
        raise InputError(f'--picture: the name must end in {", ".join(FORMATS)}, not {given.picture.name!r}')
    return given
