"""The `experiment` executable: the paper's comparison, from the episodes to the page."""

from __future__ import annotations

import argparse
import dataclasses
import os
import re
import shlex
import time
from collections.abc import Sequence
from pathlib import Path

from rich import progress as bars
from rich.console import Console
from rich.table import Table

from al_questioner.arguments import Parser, number
from al_questioner.concepts import compile_models
from al_questioner.domain import EpisodeError, SettingsError
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.figures import condition_name, draw_figures
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_CONDITIONS,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    Condition,
    Plan,
    Variation,
    shipped_weights,
)
from al_questioner.experiments.playing import Played
from al_questioner.experiments.report import Page, report
from al_questioner.experiments.results import Results, read_results
from al_questioner.experiments.running import Store, run
from al_questioner.experiments.studies import STUDIES, make_studies
from al_questioner.files import make_folder, write_text
from al_questioner.questioning import read_weights

WHOLE_RUN = 1e9
"""Seconds, longer than any experiment."""


def condition(text: str) -> Condition:
    """An argument type: C1 to C4, or BUDGET/TURNS."""
    if text in PAPER_CONDITIONS:
        return PAPER_CONDITIONS[text]
    budget, slash, turns = text.partition('/')
    try:
        found = Condition(float(budget), int(turns))
    except ValueError:
        slash = ''
    if not slash or not (0 <= found.budget < float('inf') and found.turns >= 1):
        raise argparse.ArgumentTypeError(f'must be one of {", ".join(PAPER_CONDITIONS)}, or BUDGET/TURNS, not {text}')
    return found


def parser() -> Parser:
    """The arguments of `experiment`."""
    result = Parser(prog='experiment', description="Play the paper's comparison, test it, draw it, and write it down.")
    result.add_argument('--out', type=Path, default=Path('out/experiment'), help='folder of the tables (%(default)s)')
    result.add_argument('--task', nargs='+', default=list(PAPER_TASKS), help='names in config/tasks (%(default)s)')
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
    result.add_argument('--samples', type=number(int, 1, 100_000), default=5, help='of each task (%(default)s)')
    first_help = 'number of the first sample (%(default)s)'
    result.add_argument('--first-sample', type=number(int, 0, 1_000_000), default=0, help=first_help)
    result.add_argument('--weights-file', help='weights of dt_task_env; those that ship if not given')
    result.add_argument('--change-interval', type=number(int, 1, 10_000), help="turns between changes (the task's)")
    result.add_argument('--synchrony', type=number(float, 0, 1), help="how synchronously objects change (the task's)")
    result.add_argument(
        '--wrong-rate', type=number(float, 0, 1), default=0.0, help='share of wrong answers (%(default)s)'
    )
    result.add_argument('--dataset', default='', help='root of a directory of crops, for tasks that read one')
    jobs = os.cpu_count() or 1
    result.add_argument('--jobs', type=number(int, 1, 1024), default=jobs, help='local processes (%(default)s)')
    backend_help = 'who does the work: processes here, or a dask cluster (%(default)s)'
    result.add_argument('--backend', choices=('processes', 'dask'), default='processes', help=backend_help)
    result.add_argument('--scheduler', metavar='ADDRESS', help='of the dask cluster')
    result.add_argument(
        '--page', type=Path, metavar='FILE', help='write the page there too, with its figures beside it'
    )
    return result


def main(arguments: Sequence[str]) -> int:
    """Run an experiment, or go on with one."""
    given = parser().parse_args(arguments)
    if (given.backend == 'dask') != (given.scheduler is not None):
        raise SettingsError('--backend dask and --scheduler ADDRESS belong together')
    weights = dict(shipped_weights())
    if given.weights_file:
        weights['dt_task_env'] = read_weights(Path(given.weights_file)).values
    variation = Variation(given.change_interval, given.synchrony, given.wrong_rate, weights)
    samples = tuple(range(given.first_sample, given.first_sample + given.samples))
    ceilings = [name for name in CEILINGS if given.ceilings and name not in given.strategy]
    plan = Plan(tuple(given.task), tuple(given.condition), (*given.strategy, *ceilings), samples, variation)
    names = list(STUDIES) if given.studies == [] else given.studies or []
    studies = make_studies(names, variation, samples)
    store = Store(given.out, plan, given.dataset)
    variants = {
        study.name: {
            label: Store(given.out / 'studies' / study.name / _folder_name(label), varied, given.dataset)
            for label, varied in study.plans.items()
        }
        for study in studies
    }
    stores = [store, *(found for by_label in variants.values() for found in by_label.values())]
    console = Console()
    with console.status('preparing the models, some ten seconds the first time ever'):
        compile_models()
    began = time.monotonic()
    failed = _run(stores, given, console)
    for played in failed:
        console.print(f'failed: {played.cell}: {played.error}', highlight=False, soft_wrap=True)
    total = sum(len(each.plan.cells()) for each in stores)
    if len(failed) == total:
        raise EpisodeError('every episode failed')
    tables = [path for each in stores for path in each.write_tables()]
    page = Page(
        f'python -m al_questioner experiment {shlex.join(arguments)}'.strip(),
        read_results(store.folder),
        {task: variation.task(task).scenes.change_interval for task in plan.tasks},
        (),
        {name: weights[name] for name in plan.strategies if name in weights},
        [(study, {label: read_results(s.folder) for label, s in variants[study.name].items()}) for study in studies],
    )
    paths = [*tables[:2], *_write_page(page, given.out / 'report.md')]
    if given.page:
        paths += _write_page(page, given.page)
    for task in page.results.tasks:
        console.print(_summary(page.results, task))
    for path in paths:
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    console.print(f'{total} episodes, {len(failed)} failed, {time.monotonic() - began:.0f} s')
    if failed:
        raise EpisodeError(f'{len(failed)} of {total} episodes failed; the same command tries them again')
    return 0


def _folder_name(label: str) -> str:
    return re.sub('[^a-z0-9.]+', '_', label.lower()).strip('_')


def _run(stores: Sequence[Store], given: argparse.Namespace, console: Console) -> list[Played]:
    with bars.Progress(
        bars.TextColumn('{task.completed:.0f} of {task.total:.0f} episodes'),
        bars.BarColumn(),
        bars.TextColumn('{task.description}'),
        bars.TimeElapsedColumn(),
        bars.TextColumn('left'),
        bars.TimeRemainingColumn(),
        console=console,
        transient=True,
        # The speed of the last half minute says little about episodes that take from a tenth of a second to ten.
        speed_estimate_period=WHOLE_RUN,
    ) as progress:
        bar = progress.add_task('looking what is there already', total=0)

        def watch(done: int, total: int, played: Played | None) -> None:
            if played is None:
                progress.reset(bar, total=total, completed=done, description='playing')
            else:
                progress.update(bar, completed=done, description=f'{played.cell.task} {played.cell.strategy}')

        return run(stores, given.jobs, given.scheduler, watch)


def _write_page(page: Page, path: Path) -> list[Path]:
    make_folder(path.parent)
    figures = draw_figures(page.results, page.change_intervals, path.parent / 'figures' / path.stem)
    write_text(path, report(dataclasses.replace(page, figures=figures), path.parent))
    return [path, *figures]


def _summary(results: Results, task: str) -> Table:
    """Mean accuracies at the end of the time."""
    conditions = results.conditions(task)
    table = Table(task, *(condition_name(limits) for limits in conditions))
    for name in results.strategies:
        accuracies = [results.final_accuracies(task, limits) for limits in conditions]
        table.add_row(name, *(f'{found[name].mean():.3f}' if name in found else '' for found in accuracies))
    return table
