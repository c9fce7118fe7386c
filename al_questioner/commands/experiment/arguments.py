"""The command line of `experiment`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from al_questioner.domain import AMPLITUDE, AMPLITUDE_RANGE, SettingsError
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_CONDITIONS,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    Condition,
    Plan,
    Variation,
)
from al_questioner.experiments.studies import STUDIES
from al_questioner.messages.schemas import LARGEST_TURN
from al_questioner.questioning import FEATURE_SETS
from al_questioner.support.arguments import REPEAT_SHOWN_HELP, Parser, number_within
from al_questioner.support.configuration import shipped_names


def condition(text: str) -> Condition:
    """An argument type: C1 to C4, or BUDGET/TURNS."""
    if text in PAPER_CONDITIONS:
        return PAPER_CONDITIONS[text]
    budget, slash, turns = text.partition('/')
    try:
        found = Condition(float(budget), int(turns))
    except ValueError:
        slash = ''
    if not slash or not (0 <= found.budget < float('inf') and 1 <= found.turns <= LARGEST_TURN):
        conditions = ', '.join(PAPER_CONDITIONS)
        limits = f'BUDGET/TURNS of 1 to {LARGEST_TURN} turns'
        raise argparse.ArgumentTypeError(f'must be one of {conditions}, or {limits}, not {text}')
    return found


def parser() -> Parser:
    """The arguments of `experiment`."""
    result = Parser(prog='experiment', description="Play the paper's comparison, test it, draw it, and write it down.")
    result.add_argument('--out', type=Path, default=Path('out/experiment'), help='folder of the tables (%(default)s)')
    task_help = f'{", ".join(shipped_names("tasks"))}, or YAML files (%(default)s)'
    result.add_argument('--task', nargs='+', default=list(PAPER_TASKS), help=task_help)
    result.add_argument(
        '--condition',
        nargs='+',
        type=condition,
        default=list(PAPER_CONDITIONS.values()),
        help='C1 to C4, or BUDGET/TURNS',
    )
    result.add_argument('--strategy', nargs='+', default=[*PAPER_STRATEGIES, *CONTROLS], help='(%(default)s)')
    result.add_argument('--ceilings', action='store_true', help=f'play {" and ".join(CEILINGS)} too')
    result.add_argument(
        '--studies',
        nargs='*',
        metavar='NAME',
        help=f'vary what the paper does not tell: {", ".join(STUDIES)}; all if none is named',
    )
    result.add_argument('--samples', type=number_within(int, 1, 100_000), default=5, help='of each task (%(default)s)')
    first_help = 'number of the first sample (%(default)s)'
    result.add_argument('--first-sample', type=number_within(int, 0, 1_000_000), default=0, help=first_help)
    result.add_argument('--weights-file', help=f'weights of {" or ".join(FEATURE_SETS)}; those that ship if not given')
    result.add_argument(
        '--change-interval', type=number_within(int, 1, 10_000), help="turns between changes (the task's)"
    )
    result.add_argument(
        '--synchrony', type=number_within(float, 0, 1), help="how synchronously objects change (the task's)"
    )
    result.add_argument(
        '--wrong-rate', type=number_within(float, 0, 1), default=0.0, help='share of wrong answers (%(default)s)'
    )
    result.add_argument(
        '--unknown-rate',
        type=number_within(float, 0, 1),
        default=0.0,
        help='share of questions without an answer (%(default)s)',
    )
    result.add_argument('--repeat-shown', action='store_true', help=REPEAT_SHOWN_HELP)
    result.add_argument(
        '--amplitude',
        type=number_within(float, *AMPLITUDE_RANGE),
        default=AMPLITUDE,
        help="variance of the Gaussian processes' kernel (%(default)s)",
    )
    result.add_argument('--dataset', default='', help='root of a directory of crops, for tasks that read one')
    jobs = os.cpu_count() or 1
    result.add_argument('--jobs', type=number_within(int, 1, 1024), default=jobs, help='local processes (%(default)s)')
    backend_help = 'who does the work: processes here, or a dask cluster (%(default)s)'
    result.add_argument('--backend', choices=('processes', 'dask'), default='processes', help=backend_help)
    result.add_argument('--scheduler', metavar='ADDRESS', help='of the dask cluster')
    result.add_argument(
        '--page', type=Path, metavar='FILE', help='write the page there too, with its figures beside it'
    )
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """What the arguments ask for, and as `words` the arguments themselves.

    Raises:
        InputError: they do not go together, or name an unknown task or strategy.
    """
    given = parser().parse_args(arguments)
    if (given.backend == 'dask') != (given.scheduler is not None):
        raise SettingsError('--backend dask and --scheduler ADDRESS belong together')
    given.words = tuple(arguments)
    # To refuse what is unknown before all that an experiment needs is imported.
    plan_of(given, {})
    return given


def plan_of(given: argparse.Namespace, weights: Mapping[str, Mapping[str, float]]) -> Plan:
    """The comparison that the arguments name.

    Args:
        given: the arguments.
        weights: by strategy.

    Raises:
        InputError: an unknown task or strategy, or nothing to play.
    """
    samples = range(given.first_sample, given.first_sample + given.samples)
    ceilings = [name for name in CEILINGS if given.ceilings and name not in given.strategy]
    return Plan(
        tuple(given.task),
        tuple(given.condition),
        (*given.strategy, *ceilings),
        tuple(samples),
        Variation(
            given.change_interval,
            given.synchrony,
            given.wrong_rate,
            weights,
            unknown_rate=given.unknown_rate,
            amplitude=given.amplitude,
            repeat_shown=given.repeat_shown,
        ),
    )
