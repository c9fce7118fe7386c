"""The `experiment` executable: the paper's comparison, from the episodes to the page."""

from __future__ import annotations

import argparse
import dataclasses
import re
import shlex
import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.table import Table

from al_questioner.commands.experiment.arguments import plan_of
from al_questioner.concepts import compile_models
from al_questioner.domain import CLASSIFIERS, NEVER, EpisodeError, SettingsError
from al_questioner.experiments.figures import draw_figures
from al_questioner.experiments.findings import find
from al_questioner.experiments.plan import PROPOSED, Cell, Plan, shipped_weights, strategy_to_compare
from al_questioner.experiments.playing import Played
from al_questioner.experiments.progress import ExperimentProgress
from al_questioner.experiments.report import Page, report
from al_questioner.experiments.results import Results, read_results
from al_questioner.experiments.running import run
from al_questioner.experiments.statistics import mean_and_deviation
from al_questioner.experiments.storing import Store
from al_questioner.experiments.studies import STUDIES, Study, make_studies
from al_questioner.questioning import FEATURE_SETS, STRATEGIES, Weights, make_strategy, read_weights, weight_names
from al_questioner.simulation import WorldSpec, load_task
from al_questioner.support.files import write_text
from al_questioner.support.text import number_of


def main(given: argparse.Namespace) -> int:
    """Run an experiment, or go on with one."""
    weights = dict(shipped_weights())
    if given.weights_file:
        found = read_weights(Path(given.weights_file))
        weights[_strategy_of(found, given.strategy)] = found
    plan = plan_of(given, {name: found.values for name, found in weights.items()})
    names = list(STUDIES) if given.studies == [] else given.studies or []
    studies = make_studies(names, plan.variation, plan.samples)
    _check_worlds([plan, *(variant for study in studies for variant in study.plans.values())], given)
    store = Store(given.out, plan, given.dataset)
    variants = [(study, _variant_stores(study, given)) for study in studies]
    stores = [store, *(found for _, by_label in variants for found in by_label.values())]
    console = Console()
    with console.status('preparing the models (compiling them, if need be, takes some ten seconds)'):
        compile_models()
    began = time.monotonic()
    total = sum(len(each.plan.cells()) for each in stores)
    try:
        with ExperimentProgress(console, total) as progress:
            failed = run(stores, given.jobs, given.scheduler, progress.begin, progress.watch)
    except KeyboardInterrupt:
        finished = sum(each.finished() for each in stores)
        console.print(f'interrupted, {finished} of {total} episodes are finished; the same command goes on')
        raise
    for line in _failures(failed):
        console.print(line, highlight=False, markup=False, soft_wrap=True)
    tables = [path for each in stores for path in each.write_tables()]
    if not store.finished():
        raise EpisodeError('every episode of the comparison failed')
    page = Page(
        f'python -m al_questioner experiment {shlex.join(given.words)}'.strip(),
        read_results(store.folder),
        {task: plan.variation.task(task).of_sample(plan.samples[0]).scenes.change_interval for task in plan.tasks},
        (),
        {name: weights[name] for name in plan.strategies if name in weights and name not in PROPOSED},
        [
            (study, {label: read_results(each.folder) for label, each in by_label.items() if each.finished()})
            for study, by_label in variants
        ],
        _varied(given),
        strategy_to_compare(plan.strategies, given.compare),
    )
    paths = [*tables[:2], *_write_page(page, given.out / 'report.md')]
    if given.page:
        paths += _write_page(page, given.page)
    for task in page.results.tasks:
        console.print(_summary(page.results, task, page.compared))
    findings = find(page.results, page.compared)
    for text in filter(None, (findings.rank, findings.against_controls)):
        console.print(text.replace('**', ''), highlight=False, markup=False, soft_wrap=True)
    for path in paths:
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    before = f' ({progress.before} from before)' if progress.before else ''
    console.print(f'{number_of(total, "episode")}{before}, {len(failed)} failed, {time.monotonic() - began:.0f} s')
    if failed:
        raise EpisodeError(f'{len(failed)} of {total} episodes failed; the same command tries them again')
    return 0


def _strategy_of(weights: Weights, strategies: Sequence[str]) -> str:
    """Return the strategy, of those that can be trained, that the weights are for.

    Raises:
        SettingsError: they are for none of these, or do not fit it.
    """
    for name in FEATURE_SETS:
        declared = weight_names(STRATEGIES[name]) or ()
        if name in strategies and any(each in declared for each in weights.values):
            make_strategy(name, weights.values)
            return name
    raise SettingsError('--weights-file holds no weights for any of the strategies')


def _variant_stores(study: Study, given: argparse.Namespace) -> dict[str, Store]:
    """Return the stores of a study's variants, by label."""
    folder = given.out / 'studies' / study.name
    names = {label: re.sub('[^a-z0-9.]+', '_', label.lower()).strip('_') for label in study.plans}
    return {label: Store(folder / names[label], plan, given.dataset) for label, plan in study.plans.items()}


def _check_worlds(plans: Sequence[Plan], given: argparse.Namespace) -> None:
    """See before anything is written whether the worlds can be opened.

    Raises:
        InputError: a task and the dataset do not belong together, or the dataset cannot be used.
    """
    dataset = Path(given.dataset) if given.dataset else None
    for name in dict.fromkeys(name for plan in plans for name in plan.tasks):
        task = load_task(name)
        # What workers elsewhere will read need not be here.
        if task.source == 'simulated' or dataset is None or given.scheduler is None:
            WorldSpec(task, given.first_sample, given.first_sample, dataset).open()


def _varied(given: argparse.Namespace) -> str:
    """Describe what the arguments change in the tasks, the teacher and the classifiers."""
    parts = {
        'the scene changes every {} turns': given.change_interval,
        'synchrony {}': given.synchrony,
        'no relevance query': (given.cost_relevance == NEVER) or None,
        'cost {} of a relevance query': None if given.cost_relevance == NEVER else given.cost_relevance,
        'share of wrong answers {}': given.wrong_rate or None,
        'share of questions without an answer {}': given.unknown_rate or None,
        'chance {} that a thing that matters is left out': given.relevance_omission or None,
        'chance {} that a thing of no symbol is named': given.relevance_false_alarm or None,
        'the teacher shows also what is known': given.repeat_shown or None,
        'labels are carried to all views of a thing': given.carry_labels or None,
        **{
            f'{name.replace("_", " ")} {{}}': f'{value:g}' if isinstance(value, float) else value
            for name, setting in CLASSIFIERS.items()
            if (value := getattr(given, name)) != setting.default
        },
    }
    return ', '.join(text.format(value) for text, value in parts.items() if value is not None)


def _failures(failed: Sequence[Played]) -> list[str]:
    """Return a line for each reason, with its first episode: a thousand episodes may fail for one reason."""
    by_reason: dict[str, list[Cell]] = {}
    for played in failed:
        by_reason.setdefault(played.error, []).append(played.cell)
    return [
        f'failed: {reason} ({cells[0]}{f", and {len(cells) - 1} more" if len(cells) > 1 else ""})'
        for reason, cells in by_reason.items()
    ]


def _write_page(page: Page, path: Path) -> list[Path]:
    figures = draw_figures(page.results, page.change_intervals, path.parent / 'figures' / path.stem, page.compared)
    write_text(path, report(dataclasses.replace(page, figures=figures), path.parent))
    return [path, *figures]


def _summary(results: Results, task: str, compared: str | None) -> Table:
    """Mean and standard deviation of the accuracies at the end of the time, with the compared strategy in bold."""
    conditions = results.conditions(task)
    table = Table(task, *map(results.name_of, conditions))
    for name in results.strategies:
        accuracies = [results.final_accuracies(task, limits) for limits in conditions]
        cells = [mean_and_deviation(found[name]) if name in found else '' for found in accuracies]
        table.add_row(name, *cells, style='bold' if name == compared else None)
    return table
