"""The command line of `demo`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain import InputError
from al_questioner.messages.schemas import LARGEST_TURN
from al_questioner.questioning import STRATEGIES
from al_questioner.support.arguments import LARGEST_SEED, REPEAT_SHOWN_HELP, Parser, number_within
from al_questioner.support.configuration import shipped_names


def parser() -> Parser:
    """The arguments of `demo`."""
    result = Parser(prog='demo', description='Play one learning episode, show how it goes, and draw how it went.')
    tasks = ', '.join(shipped_names('tasks'))
    task_help = f'{tasks}, or a YAML file (%(default)s)'
    result.add_argument('--task', default='kitchen_table', help=task_help)
    result.add_argument('--dataset', type=Path, help='root of a directory of RGB-D crops, for tasks that read one')
    result.add_argument('--strategy', help=f"one of {', '.join(STRATEGIES)}, or of an installed package (the task's)")
    result.add_argument('--weights-file', help='YAML file with weights of the decision features')
    result.add_argument('--budget', type=float, help="query budget (the task's)")
    turns = number_within(int, 1, LARGEST_TURN)
    result.add_argument('--turns', type=turns, help="length of the episode (the task's)")
    tune_every = number_within(int, 0, LARGEST_TURN)
    tune_help = "turns from one re-optimisation of the models' kernel to the next, 0 for never (%(default)s)"
    result.add_argument('--tune-every', type=tune_every, default=0, metavar='K', help=tune_help)
    seed = number_within(int, 0, LARGEST_SEED)
    result.add_argument('--seed', type=seed, default=0, help='seed of everything drawn at random (%(default)s)')
    result.add_argument('--sample', type=seed, help='sample of observations to draw the scenes from (that of the seed)')
    result.add_argument('--wrong-rate', type=float, default=0.0, help='share of wrong answers (%(default)s)')
    result.add_argument('--unknown-rate', type=float, default=0.0, help='share of "I do not know" (%(default)s)')
    result.add_argument('--repeat-shown', action='store_true', help=REPEAT_SHOWN_HELP)
    period = number_within(float, 0, 3600)
    period_help = 'least seconds from turn to turn, not offline (%(default)s)'
    result.add_argument('--turn-period', type=period, default=0.0, help=period_help)
    result.add_argument('--out', type=Path, default=Path('out/demo'), help='folder for the pictures (%(default)s)')
    result.add_argument('--json', type=Path, metavar='FILE', help='write the episode as JSON')
    result.add_argument('--record', type=Path, metavar='BAG', help='record the episode into a new bag, not offline')
    result.add_argument('--namespace', help='of the ROS topics, not offline (one of its own for each run)')
    dry_help = 'offline, on made-up features: tries a task without the robot whose things it is about'
    result.add_argument('--dry-run', action='store_true', help=dry_help)
    where = result.add_mutually_exclusive_group()
    where.add_argument('--offline', action='store_true', help='the same episode without ROS')
    where.add_argument('--one-process', action='store_true', help='the ROS nodes in this process, not one process each')
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """What the arguments ask for.

    Raises:
        InputError: they do not go together, or a bag is there already.
    """
    given = parser().parse_args(arguments)
    without_ros = '--dry-run' if given.dry_run else '--offline'
    given.offline = given.offline or given.dry_run
    for option in ('record', 'namespace', 'one_process'):
        if given.offline and getattr(given, option):
            raise InputError(f'--{option.replace("_", "-")} is of no use with {without_ros}: there is no ROS graph')
    if given.dry_run and given.dataset:
        raise InputError('--dataset is of no use with --dry-run: its features are made up')
    if given.record and given.one_process:
        raise InputError('--record needs a process for each node: leave --one-process out')
    if given.record and given.record.exists():
        raise InputError(f'--record: {given.record} exists already; a bag is never overwritten')
    if given.strategy == 'human' and not (given.offline or given.one_process):
        raise InputError('strategy human reads this terminal: use --offline or --one-process with it')
    return given
