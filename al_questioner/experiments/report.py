"""The page that tells what was reproduced, written from the tables."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from al_questioner.experiments.claims import OURS, verdicts
from al_questioner.experiments.figures import condition_name
from al_questioner.experiments.plan import CONTROLS, Condition
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import compare

ABOUT_CLAIMS = """\
A claim about significance counts as reproduced if Holm-corrected one-tailed Mann-Whitney U tests of the accuracies at
the end of the time (the test of the paper, which corrects nothing) are below .05 for all that it names. The paper does
not tell the weights of dt_iros and dt_task; ours are set by hand. Where they ask fewer questions than the paper's, the
comparison flatters dt_task_env."""

ABOUT_TESTS = """\
One-tailed tests that it is more accurate: Mann-Whitney U, Holm-corrected within each condition over all strategies
shown, and, since all strategies share samples, scenes and seeds, the paired Wilcoxon signed-rank test. Superiority is
the probability that a sample of it is above one of the other, with a 95 % bootstrap interval. With five samples the
smallest possible p is .004 of Mann-Whitney and .031 of Wilcoxon."""


def report(results: Results, command: str, figures: Sequence[Path], page_folder: Path) -> str:
    """The page in Markdown.

    Args:
        results: of the experiment.
        command: that produced them.
        figures: pictures to show.
        page_folder: where the page will lie, for the links.
    """
    parts = [
        '# Reproduction',
        f'Written by `{command}`; every number on this page is from its tables.',
        _first_paragraph(results),
        '## What the paper claims',
        _claims(results),
        ABOUT_CLAIMS,
        '## Accuracy at the end of the time',
        *(_accuracies(results, task) for task in results.tasks),
        f'## {OURS} against each other strategy',
        ABOUT_TESTS,
        *(_comparisons(results, task) for task in results.tasks),
        '## Figures',
        *(f'![{path.stem.replace("_", " ")}]({_relative(path, page_folder)})' for path in figures),
    ]
    return '\n\n'.join(parts) + '\n'


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
                beaten.append(f'{task}, {condition_name(condition)}: {best} {controls[best]:.3f}, {OURS} {ours:.3f}')
    if not cells:
        return 'No control was played beside the strategies of the paper.'
    if not beaten:
        return f'In none of the {cells} cells is a control more accurate, in the mean, than {OURS}.'
    listed = '\n'.join(f'- {line}' for line in beaten)
    return (
        f'**A simple control is more accurate, in the mean, than {OURS} in {len(beaten)} of {cells} cells**'
        f' (the best control of each):\n\n{listed}'
    )


def _claims(results: Results) -> str:
    rows = [(v.claim, v.found, 'reproduced' if v.reproduced else '**not reproduced**') for v in verdicts(results)]
    return _table(('claim', 'found', 'verdict'), rows)


def _accuracies(results: Results, task: str) -> str:
    conditions = results.conditions(task)
    rows = []
    for strategy in results.strategies:
        cells = [_mean_and_deviation(results, task, condition, strategy) for condition in conditions]
        rows.append((f'`{strategy}`', *cells))
    samples = len({row.cell.sample for row in results.episodes if row.cell.task == task})
    head = (f'{task}, {samples} samples', *(condition_name(condition) for condition in conditions))
    return _table(head, rows) + '\n\nMean and standard deviation; in brackets the mean number of queries.'


def _mean_and_deviation(results: Results, task: str, condition: Condition, strategy: str) -> str:
    group = results.group(task, condition, strategy)
    if not group:
        return ''
    values = np.array([row.final_accuracy for row in group])
    deviation = values.std(ddof=1) if len(values) > 1 else 0.0
    return f'{values.mean():.3f} ± {deviation:.3f} ({np.mean([row.queries for row in group]):.0f})'


def _comparisons(results: Results, task: str) -> str:
    rows = []
    for condition in results.conditions(task):
        accuracies = results.final_accuracies(task, condition)
        if OURS not in accuracies:
            continue
        others = {name: values for name, values in accuracies.items() if name != OURS}
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


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    lines = [head, ['---'] * len(head), *rows]
    return '\n'.join(f'| {" | ".join(line)} |' for line in lines)
