"""The `experiment` executable: the paper's comparison, from the episodes to the page."""

from __future__ import annotations

import argparse
import os
import shlex
import time
from collections.abc import Sequence
from pathlib import Path

from rich import progress as bars
from rich.console import Console
from rich.table import Table

from al_questioner.arguments import Parser, number
from al_questioner.concepts import compile_models
from al_questioner.domain import EpisodeError
from al_questioner.experiments.figures import condition_name, draw_figures
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_CONDITIONS,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    Condition,
    Plan,
    Variation,
)
from al_questioner.experiments.playing import Played
from al_questioner.experiments.report import report
from al_questioner.experiments.results import Results, read_results
from al_questioner.experiments.running import Store, run
from al_questioner.files import make_folder, write_text
from al_questioner.questioning import read_weights


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
    result.add_argument('--samples', type=number(int, 1, 100_000), default=5, help='of each task (%(default)s)')
    result.add_argument('--weights-file', help='weights of dt_task_env; those that ship if not given')
    result.add_argument('--change-interval', type=number(int, 1, 10_000), help="turns between changes (the task's)")
    result.add_argument('--synchrony', type=number(float, 0, 1), help="how synchronously objects change (the task's)")
    result.add_argument(
        '--wrong-rate', type=number(float, 0, 1), default=0.0, help='share of wrong answers (%(default)s)'
    )
    result.add_argument('--dataset', default='', help='root of a directory of crops, for tasks that read one')
    jobs = os.cpu_count() or 1
    result.add_argument('--jobs', type=number(int, 1, 1024), default=jobs, help='local processes (%(default)s)')
    result.add_argument('--scheduler', metavar='ADDRESS', help='of a dask cluster that does the work instead')
    result.add_argument(
        '--page', type=Path, metavar='FILE', help='write the page there too, with its figures beside it'
    )
    return result


def main(arguments: Sequence[str]) -> int:
    """Run an experiment, or go on with one."""
    given = parser().parse_args(arguments)
    weights = {'dt_task_env': read_weights(Path(given.weights_file)).values} if given.weights_file else {}
    variation = Variation(given.change_interval, given.synchrony, given.wrong_rate, weights)
    plan = Plan(
        tuple(given.task), tuple(given.condition), tuple(given.strategy), tuple(range(given.samples)), variation
    )
    store = Store(given.out, plan, given.dataset)
    console = Console()
    with console.status('preparing the models, some ten seconds the first time ever'):
        compile_models()
    began = time.monotonic()
    failed = _run(plan, store, given, console)
    tables = store.write_tables(plan.cells())
    for played in failed:
        console.print(f'failed: {played.cell}: {played.error}', highlight=False, soft_wrap=True)
    if len(failed) == len(plan.cells()):
        raise EpisodeError('every episode failed')
    results = read_results(given.out)
    intervals = {task: variation.task(task).scenes.change_interval for task in plan.tasks}
    command = f'python -m al_questioner experiment {shlex.join(arguments)}'.strip()
    paths = [*tables, *_write_page(results, intervals, command, given.out / 'report.md')]
    if given.page:
        paths += _write_page(results, intervals, command, given.page)
    for task in results.tasks:
        console.print(_summary(results, task))
    for path in paths:
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    console.print(f'{len(plan.cells())} episodes, {len(failed)} failed, {time.monotonic() - began:.0f} s')
    if failed:
        raise EpisodeError(f'{len(failed)} of {len(plan.cells())} episodes failed; the same command tries them again')
    return 0


def _run(plan: Plan, store: Store, given: argparse.Namespace, console: Console) -> list[Played]:
    with bars.Progress(
        bars.TextColumn('{task.completed:.0f} of {task.total:.0f} episodes'),
        bars.BarColumn(),
        bars.TextColumn('{task.description}'),
        bars.TimeElapsedColumn(),
        bars.TextColumn('left'),
        bars.TimeRemainingColumn(),
        console=console,
        transient=True,
    ) as progress:
        bar = progress.add_task('', total=len(plan.cells()))

        def watch(done: int, total: int, played: Played) -> None:
            progress.update(bar, completed=done, description=f'{played.cell.task} {played.cell.strategy}')

        return run(plan, store, given.jobs, given.scheduler, given.dataset, watch)


def _write_page(results: Results, intervals: dict[str, int], command: str, page: Path) -> list[Path]:
    make_folder(page.parent)
    figures = draw_figures(results, intervals, page.parent / 'figures' / page.stem)
    write_text(page, report(results, command, figures, page.parent))
    return [page, *figures]


def _summary(results: Results, task: str) -> Table:
    """Mean accuracies at the end of the time."""
    conditions = results.conditions(task)
    table = Table(task, *(condition_name(limits) for limits in conditions))
    for name in results.strategies:
        accuracies = [results.final_accuracies(task, limits) for limits in conditions]
        table.add_row(name, *(f'{found[name].mean():.3f}' if name in found else '' for found in accuracies))
    return table
