"""The command line of `experiment`; what only its work needs is not imported."""

from __future__ import annotations

import argparse
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from al_questioner.domain import (
    BUDGET,
    CARRY_LABELS,
    CLASSIFIERS,
    COST_RELEVANCE,
    TURNS,
    Classifiers,
    Setting,
    SettingsError,
)
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_CONDITIONS,
    PAPER_METHOD,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    Condition,
    Plan,
    Variation,
    strategy_to_compare,
)
from al_questioner.experiments.studies import STUDIES
from al_questioner.questioning import FEATURE_SETS
from al_questioner.simulation.scripted_teacher import (
    RELEVANCE_FALSE_ALARM,
    RELEVANCE_OMISSION,
    REPEAT_SHOWN,
    UNKNOWN_RATE,
    WRONG_RATE,
)
from al_questioner.simulation.task import SCENE_INTERVAL, SYNCHRONY
from al_questioner.simulation.world_spec import DATASET
from al_questioner.support.arguments import JOBS, NumberWithin, Parser, add_option
from al_questioner.support.configuration import shipped_names

SAMPLES = Setting('samples', 5, 'of each task', lower=1, upper=100_000)
FIRST_SAMPLE = Setting('first_sample', 0, 'number of the first sample', lower=0, upper=1_000_000)


def condition(text: str) -> Condition:
    """Read a condition, C1 to C4 or BUDGET/TURNS, for argparse."""
    if text in PAPER_CONDITIONS:
        return PAPER_CONDITIONS[text]
    budget, _, turns = text.partition('/')
    try:
        found = Condition(float(budget), int(turns))
        BUDGET.check(found.budget)
        TURNS.check(found.turns)
    except ValueError as error:
        conditions = ', '.join(PAPER_CONDITIONS)
        limits = f'BUDGET/TURNS of {TURNS.limits} turns'
        raise argparse.ArgumentTypeError(f'must be one of {conditions}, or {limits}, not {text}') from error
    return found


def parser() -> Parser:
    """Make the parser of `experiment`."""
    result = Parser(
        prog='experiment',
        description="Play the paper's comparison, or another one, test it, draw it, and write it down.",
    )
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
    result.add_argument(
        '--compare',
        metavar='NAME',
        help=f'strategy that is tested against the others ({PAPER_METHOD}, or the first one if that is not played)',
    )
    result.add_argument(
        '--ceilings',
        nargs='?',
        type=NumberWithin(int, SAMPLES.lower, SAMPLES.largest),
        const=SAMPLES.largest,
        metavar='SAMPLES',
        help=f'play {" and ".join(CEILINGS)} too, on the first samples, or on all if no number is given',
    )
    result.add_argument(
        '--studies',
        nargs='*',
        metavar='NAME',
        help=f'vary what the paper does not tell: {", ".join(STUDIES)}; all if none is named',
    )
    add_option(result, SAMPLES)
    add_option(result, FIRST_SAMPLE)
    result.add_argument('--weights-file', help=f'weights of {" or ".join(FEATURE_SETS)}; those that ship if not given')
    add_option(result, SCENE_INTERVAL, "the task's")
    add_option(result, SYNCHRONY, "the task's")
    add_option(result, COST_RELEVANCE, "the task's")
    teacher: tuple[Setting[Any], ...] = (
        WRONG_RATE,
        UNKNOWN_RATE,
        RELEVANCE_OMISSION,
        RELEVANCE_FALSE_ALARM,
        REPEAT_SHOWN,
    )
    for setting in (*teacher, *CLASSIFIERS.values(), CARRY_LABELS):
        add_option(result, setting)
    add_option(result, DATASET, help=DATASET.description)
    add_option(result, JOBS, 'one for each processor')
    backend_help = 'who does the work: processes here, or a dask cluster (%(default)s)'
    result.add_argument('--backend', choices=('processes', 'dask'), default='processes', help=backend_help)
    result.add_argument('--scheduler', metavar='ADDRESS', help='of the dask cluster')
    result.add_argument(
        '--page', type=Path, metavar='FILE', help='write the page there too, with its figures beside it'
    )
    return result


def parse(arguments: Sequence[str]) -> argparse.Namespace:
    """Parse the arguments; `words` holds the arguments themselves.

    Raises:
        InputError: they do not go together, or name an unknown task or strategy.
    """
    given = parser().parse_args(arguments)
    if (given.backend == 'dask') != (given.scheduler is not None):
        raise SettingsError('--backend dask and --scheduler ADDRESS belong together')
    given.words = tuple(arguments)
    given.jobs = given.jobs or os.cpu_count() or 1
    # To refuse what is unknown before all that an experiment needs is imported.
    strategy_to_compare(plan_of(given, {}).strategies, given.compare)
    return given


def plan_of(given: argparse.Namespace, weights: Mapping[str, Mapping[str, float]]) -> Plan:
    """Return the comparison that the arguments name, with the weights of each strategy.

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
            classifiers=Classifiers(**{name: getattr(given, name) for name in CLASSIFIERS}),
            repeat_shown=given.repeat_shown,
            cost_relevance=given.cost_relevance,
            relevance_omission=given.relevance_omission,
            relevance_false_alarm=given.relevance_false_alarm,
            carry_labels=given.carry_labels,
        ),
        given.ceilings,
    )
