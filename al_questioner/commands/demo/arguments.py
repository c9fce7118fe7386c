"""The command line of `demo`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from al_questioner.domain import BUDGET, CARRY_LABELS, TURNS, InputError
from al_questioner.questioning.strategies.names import STRATEGY
from al_questioner.questioning.strategies.weights import WEIGHTS_FILE
from al_questioner.ros.settings import TURN_PERIOD
from al_questioner.simulation.scripted_teacher import (
    RELEVANCE_FALSE_ALARM,
    RELEVANCE_OMISSION,
    REPEAT_SHOWN,
    UNKNOWN_RATE,
    WRONG_RATE,
)
from al_questioner.simulation.world_spec import DATASET, SAMPLE, SEED, TASK
from al_questioner.support.arguments import DEFAULT, Parser, add_option
from al_questioner.support.configuration import shipped_names


def parser() -> Parser:
    """Make the parser of `demo`."""
    result = Parser(prog='demo', description='Play one learning episode, show how it goes, and draw how it went.')
    add_option(result, TASK, help=f'{", ".join(shipped_names("tasks"))}, or a YAML file ({DEFAULT})')
    add_option(result, DATASET, type=Path, default=None, help=DATASET.description)
    add_option(result, STRATEGY, "the task's")
    add_option(result, WEIGHTS_FILE, 'those that ship', help='YAML file with weights of the strategy (those that ship)')
    add_option(result, BUDGET, "the task's")
    add_option(result, TURNS, "the task's")
    add_option(result, SEED)
    add_option(result, SAMPLE, default=None, help=SAMPLE.description)
    for setting in (WRONG_RATE, UNKNOWN_RATE, RELEVANCE_OMISSION, RELEVANCE_FALSE_ALARM, REPEAT_SHOWN):
        add_option(result, setting)
    add_option(result, CARRY_LABELS)
    add_option(result, TURN_PERIOD, f'{DEFAULT}, not offline')
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
    """Parse the arguments.

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
