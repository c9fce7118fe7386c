"""The page that tells what was reproduced, written from the tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.claims import OURS, verdicts
from al_questioner.experiments.figures import condition_name
from al_questioner.experiments.plan import CONTROLS, Condition
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import compare, holm, p_text
from al_questioner.experiments.studies import Study

PAPER_SAMPLES = 5

ABOUT_CLAIMS = """\
A claim about significance counts as reproduced if Holm-corrected one-tailed Mann-Whitney U tests of the accuracies at
the end of the time (the test of the paper, which corrects nothing) are below .05 for all that it names. Superiority is
the probability that a sample of dt_task_env is above one of the other. Where the paper gives no number, the bound in
brackets is ours."""

ABOUT_WEIGHTS = """\
The paper set the weights of dt_iros and dt_task by hand and does not tell them. Ours were chosen so that they ask about
as much as the paper's in C4 (9 and 22 queries), on samples that are not on this page (1000 to 1009); the number of
queries alone decided. The weights of dt_task_env were learnt from an expert's three recorded episodes with a budget of
15, 30 turns and a change every 10, before anything on this page was played."""

ABOUT_ACCURACIES = """\
Mean and standard deviation over the samples; in brackets the mean number of queries. `all_labels` and `greedy_oracle`
are ceilings that know the truth: one is told every label as it comes into sight, and the relevant features, for
nothing; the other spreads its budget over the scenes and takes each time the label that leads to the highest accuracy
at once, on a second draw of held-out views."""

ABOUT_TESTS = """\
One-tailed tests that it is more accurate: Mann-Whitney U, Holm-corrected within each condition over all strategies
shown, and, since all strategies share samples, scenes and seeds, the paired Wilcoxon signed-rank test. Superiority is
the probability that a sample of it is above one of the other, with a 95 % bootstrap interval."""

ABOUT_CALIBRATION = """\
All settings of the simulated world that were tried before any strategy was compared in it, with what each gave, are
listed in [world.md](world.md#how-hard-they-are); the paces that were tried for the scripted expert, the settings of the
training, and where it fails, in [method.md](method.md#imitation)."""


@dataclass(frozen=True, eq=False)
class Page:
    """What a page is about.

    Attributes:
        command: that produced it.
        results: of the comparison.
        change_intervals: turns between scene changes, by task.
        figures: pictures to show.
        weights: of the decision-theoretic strategies.
        studies: with the results of their variants, by label.
    """

    command: str
    results: Results
    change_intervals: Mapping[str, int]
    figures: Sequence[Path]
    weights: Mapping[str, Mapping[str, float]]
    studies: Sequence[tuple[Study, Mapping[str, Results]]] = field(default=())


def report(page: Page, folder: Path) -> str:
    """The page in Markdown.

    Args:
        page: its contents.
        folder: where it will lie, for the links.
    """
    results = page.results
    parts = [
        '# Reproduction',
        f'Written by `{page.command}`; every number on this page is from its tables.',
        _first_paragraph(results),
        _second_paragraph(results, page.change_intervals),
        '## What the paper claims',
        *_claims(results, page.change_intervals),
        '## The weights',
        ABOUT_WEIGHTS,
        _weights(page.weights),
        '## Accuracy at the end of the time',
        ABOUT_ACCURACIES,
        *(_accuracies(results, task) for task in results.tasks),
        f'## {OURS} against each other strategy',
        ABOUT_TESTS,
        *(_comparisons(results, task) for task in results.tasks),
        '## Figures',
        *(f'![{path.stem.replace("_", " ")}]({_relative(path, folder)})' for path in page.figures),
    ]
    if page.studies:
        parts += ['## What the paper does not tell', ABOUT_CALIBRATION]
        for study, found in page.studies:
            parts += [f'### {study.title}', study.about, *_study(study, results, found)]
    return '\n\n'.join(part for part in parts if part) + '\n'


def _relative(path: Path, folder: Path) -> str:
    try:
        return path.resolve().relative_to(folder.resolve()).as_posix()
    except ValueError:
        return path.as_posix()


def _first_paragraph(results: Results) -> str:
    """What a reader must not miss: where a simple rule is better than the paper's method."""
    beaten, cells = [], 0
    for task in results.tasks:
        for condition in results.conditions(task):
            accuracies = results.final_accuracies(task, condition)
            controls = {name: float(accuracies[name].mean()) for name in CONTROLS if name in accuracies}
            if OURS not in accuracies or not controls:
                continue
            cells += 1
            best = max(controls, key=lambda name: controls[name])
            ours = float(accuracies[OURS].mean())
            if controls[best] > ours:
                tests = [compare(accuracies[name], {OURS: accuracies[OURS]})[0].p for name in controls]
                p = dict(zip(controls, holm(tests), strict=True))[best]
                where = f'{task}, {condition_name(condition)}'
                beaten.append(f'{where}: {best} {controls[best]:.3f}, {OURS} {ours:.3f} ({p_text(p)})')
    if not cells:
        return 'No control was played beside the strategies of the paper.'
    if not beaten:
        return f'In none of the {cells} cells is a control more accurate, in the mean, than {OURS}.'
    listed = '\n'.join(f'- {line}' for line in beaten)
    return (
        f'**A simple control is more accurate, in the mean, than {OURS} in {len(beaten)} of {cells} cells**'
        ' (the best control of each; one-tailed Mann-Whitney U tests, Holm-corrected for the number of controls):'
        f'\n\n{listed}'
    )


def _second_paragraph(results: Results, change_intervals: Mapping[str, int]) -> str:
    """How many of the paper's claims hold."""
    counts = []
    for samples in dict.fromkeys((results.samples[:PAPER_SAMPLES], results.samples)):
        found = [verdict.reproduced for verdict in verdicts(results.of_samples(samples), change_intervals)]
        if not found:
            return ''
        counts.append(f'{sum(found)} of {len(found)} on {_count(samples).lower()}')
    return f"Of the paper's claims below, {' and '.join(counts)} are reproduced."


def _claims(results: Results, change_intervals: Mapping[str, int]) -> list[str]:
    """The claims, tested on as many samples as the paper had, and, if there are more, on all."""
    first = results.samples[:PAPER_SAMPLES]
    parts = [ABOUT_CLAIMS]
    for samples in dict.fromkeys((first, results.samples)):
        rows = [
            (v.claim, v.found, v.tests, 'reproduced' if v.reproduced else '**not reproduced**')
            for v in verdicts(results.of_samples(samples), change_intervals)
        ]
        if not rows:
            return ['The strategies of the paper were not all played in one of its conditions: no claim is tested.']
        parts += [f'### {_count(samples)}', _table(('claim', 'found', 'tests', 'verdict'), rows)]
    return parts


def _count(samples: Sequence[int]) -> str:
    return 'One sample' if len(samples) == 1 else f'{len(samples)} samples'


def _weights(weights: Mapping[str, Mapping[str, float]]) -> str:
    names = list(dict.fromkeys(feature for values in weights.values() for feature in values))
    rows = [
        (f'`{strategy}`', *(f'{values[name]:.3f}' if name in values else '' for name in names))
        for strategy, values in weights.items()
    ]
    return _table(('', *(name.replace('_', ' ') for name in names)), rows)


def _accuracies(results: Results, task: str) -> str:
    conditions = results.conditions(task)
    rows = []
    for strategy in results.strategies:
        cells = [_mean_and_deviation(results, task, condition, strategy) for condition in conditions]
        rows.append((f'`{strategy}`', *cells))
    head = (f'{task}, {_count(results.samples).lower()}', *(condition_name(condition) for condition in conditions))
    return _table(head, rows)


def _mean_and_deviation(results: Results, task: str, condition: Condition, strategy: str) -> str:
    group = results.group(task, condition, strategy)
    if not group:
        return ''
    values = np.array([row.final_accuracy for row in group])
    deviation = values.std(ddof=1) if len(values) > 1 else 0.0
    asked = '' if strategy == 'all_labels' else f' ({np.mean([row.queries for row in group]):.0f})'
    return f'{values.mean():.3f} ± {deviation:.3f}{asked}'


def _comparisons(results: Results, task: str) -> str:
    rows = []
    for condition in results.conditions(task):
        accuracies = results.final_accuracies(task, condition)
        if OURS not in accuracies:
            continue
        others = {name: values for name, values in accuracies.items() if name != OURS and name not in CEILINGS}
        for c in compare(accuracies[OURS], others):
            low, high = c.interval
            rows.append(
                (
                    condition_name(condition),
                    f'`{c.other}`',
                    f'{c.mean - c.other_mean:+.3f}',
                    f'{c.p:.4f}',
                    f'{c.p_holm:.4f}',
                    f'{c.superiority:.2f} [{low:.2f}, {high:.2f}]',
                    f'{c.p_paired:.4f}',
                )
            )
    return _table((task, 'against', 'difference', 'p', 'Holm', 'superiority', 'paired p'), rows)


def _study(study: Study, comparison: Results, found: Mapping[str, Results]) -> list[str]:
    """A table of each cell with a column for each variant, or, of a single strategy, one with a row for each."""
    plan = next(iter(study.plans.values()))
    columns = {study.own: comparison.of_samples(plan.samples), **found}
    cells = [(task, condition) for task in plan.tasks for condition in plan.conditions]
    about = f'{_count(plan.samples)}; "{study.own}" is the comparison above.'
    if len(plan.strategies) == 1:
        (strategy,) = plan.strategies
        rows = [
            (label, *(_mean_and_deviation(results, task, condition, strategy) for task, condition in cells))
            for label, results in columns.items()
        ]
        head = (f'`{strategy}`', *(f'{task}, {condition_name(condition)}' for task, condition in cells))
        return [about, _table(head, rows)]
    tables = []
    for task, condition in cells:
        rows = [
            (f'`{name}`', *(_mean_and_deviation(results, task, condition, name) for results in columns.values()))
            for name in plan.strategies
        ]
        tables.append(_table((f'{task}, {condition_name(condition)}', *columns), rows))
    return [about, *tables]


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)
