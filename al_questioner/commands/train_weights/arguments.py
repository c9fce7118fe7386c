"""The command line of `train_weights`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain import InputError
from al_questioner.imitation.settings import METHODS, RIDGE, MatchingSettings
from al_questioner.questioning import FEATURE_SETS
from al_questioner.simulation.world_spec import SEED
from al_questioner.support.arguments import JOBS, NumberWithin, Parser, add_option
from al_questioner.support.configuration import named_bag

MOST = 10_000

FORMATS = ('.png', '.pdf', '.svg')
"""Formats of the picture."""


def parser() -> Parser:
    """Make the parser of `train_weights`."""
    defaults = MatchingSettings()
    result = Parser(prog='train_weights', description="Learn a strategy's weights from an expert's recorded episodes.")
    bags_help = 'a bag of the `record` executable, or the name of one that ships, such as expert_0'
    result.add_argument('bags', nargs='+', metavar='BAG', help=bags_help)
    result.add_argument('--out', type=Path, required=True, metavar='FILE', help='the YAML file to write')
    strategy_help = 'whose weights are learnt (%(default)s)'
    result.add_argument('--strategy', choices=tuple(FEATURE_SETS), default='dt_task_env', help=strategy_help)
    result.add_argument(
        '--method',
        choices=METHODS,
        default=METHODS[0],
        help='maxent: match the feature counts in rollouts, for simulated worlds (default);'
        ' choice: likelihood of the choices, without a simulator',
    )
    add_option(result, SEED, help='of the rollouts (%(default)s)')
    iterations_help = 'of maxent, at most (%(default)s)'
    patience_help = (
        'iterations of maxent without a new smallest gap, training or validation, until it stops (%(default)s)'
    )
    result.add_argument(
        '--iterations', type=NumberWithin(int, 2, MOST), default=defaults.iterations, help=iterations_help
    )
    result.add_argument('--patience', type=NumberWithin(int, 1, MOST), default=defaults.patience, help=patience_help)
    rollouts_help = 'of each demonstration at each iteration of maxent (%(default)s)'
    result.add_argument('--rollouts', type=NumberWithin(int, 2, MOST), default=defaults.rollouts, help=rollouts_help)
    validation_help = 'number of demonstrations, the last ones, that choose among the iterations (%(default)s)'
    result.add_argument('--validation', type=NumberWithin(int, 0, MOST), default=1, help=validation_help)
    ridge_help = 'strength of the prior of choice (%(default)s)'
    result.add_argument('--ridge', type=NumberWithin(float, 0, 1e6), default=RIDGE, help=ridge_help)
    add_option(result, JOBS, default=None, help='processes of maxent (one for each processor)')
    result.add_argument('--picture', type=Path, metavar='FILE', help='(the name of --out, ending in .png)')
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments.

    Raises:
        InputError: the picture has no name that it can have, or there is no such bag.
    """
    given = parser().parse_args(arguments)
    given.bags = [named_bag(bag) for bag in given.bags]
    given.jobs = given.jobs or os.cpu_count() or 1
    given.picture = given.picture or given.out.with_suffix('.png')
    if given.picture.resolve() == given.out.resolve():
        raise InputError(f'{given.picture} cannot be the weights and the picture: name one of them otherwise')
    if given.picture.suffix not in FORMATS:
        raise InputError(f'--picture: the name must end in {", ".join(FORMATS)}, not {given.picture.name!r}')
    return given
