"""What a questioner is worth beside the others: tables, tests and the figure of accuracy against cost.

    python benchmarks/questioners.py FOLDER [FOLDER ...] [--strategy NAME] [--figures DIR]

Each folder is the --out of an experiment; together they hold the cells of all strategies that are compared, on the same
samples. Printed are, by task and condition, the accuracy at the end of the time and its mean over the turns, with the
standard deviation over the samples; then the differences to each strategy of the paper and to the best control, with
one-tailed p-values of Wilcoxon's signed-rank test and of the Mann-Whitney U test, both corrected by Holm's method over
all cells; then both averaged over the conditions, for each task.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.stats import mannwhitneyu

from al_questioner.experiments.figures import draw_cost_curves
from al_questioner.experiments.plan import CONTROLS, PAPER_CONDITIONS, PAPER_STRATEGIES, Condition
from al_questioner.experiments.results import Results, read_together
from al_questioner.experiments.statistics import holm, paired_p

Pair = tuple[np.ndarray, np.ndarray]


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folders', nargs='+', type=Path)
    parser.add_argument('--strategy', default='value_per_cost')
    parser.add_argument('--figures', type=Path)
    given = parser.parse_args()
    results = read_together(given.folders)
    shared = shared_by_all(results)
    for task in results.tasks:
        print(f'\n{task}, {len(shared.samples)} samples\n')
        print_accuracies(shared, task)
    for other in PAPER_STRATEGIES:
        cells = {(task, c): pair_of(results, task, c, given.strategy, other) for task, c in all_cells(results)}
        print(f'\n{given.strategy} against {other}\n')
        print_tests(cells, dict.fromkeys(cells, other))
    best = {cell: best_control(results, *cell) for cell in all_cells(results)}
    print(f'\n{given.strategy} against the best control of each cell\n')
    print_tests({cell: pair_of(results, *cell, given.strategy, best[cell]) for cell in best}, best)
    print('\nmean over the conditions, of each sample\n')
    print_averages(results, given.strategy)
    if given.figures:
        for path in draw_cost_curves(shared, given.figures):
            print(path)


def shared_by_all(results: Results) -> Results:
    """The samples that every strategy played in every cell that it played at all."""
    samples = set(results.samples)
    for task, condition in all_cells(results):
        for strategy in results.strategies:
            group = results.group(task, condition, strategy)
            samples &= {row.cell.sample for row in group} or samples
    return results.of_samples(samples)


def all_cells(results: Results) -> list[tuple[str, Condition]]:
    """Task and condition of each."""
    return [(task, condition) for task in results.tasks for condition in results.conditions(task)]


def best_control(results: Results, task: str, condition: Condition) -> str:
    """The control of largest mean accuracy."""
    means = {name: results.mean_accuracy(task, condition, name) for name in CONTROLS}
    return max((name for name in means if means[name] is not None), key=lambda name: means[name] or 0.0)


def pair_of(results: Results, task: str, condition: Condition, first: str, other: str) -> Pair:
    """(n,) accuracies of both, of the samples that both have."""
    groups = [
        {row.cell.sample: row.final_accuracy for row in results.group(task, condition, s)} for s in (first, other)
    ]
    shared = sorted(groups[0].keys() & groups[1].keys())
    ours, theirs = (np.array([group[sample] for sample in shared]) for group in groups)
    return ours, theirs


def print_accuracies(results: Results, task: str) -> None:
    """Accuracy at the end, and in brackets its mean over the turns."""
    conditions = results.conditions(task)
    rows = []
    for name in results.strategies:
        row = [f'`{name}`']
        for condition in conditions:
            group = results.group(task, condition, name)
            final = np.array([episode.final_accuracy for episode in group])
            mean = np.mean([episode.mean_accuracy for episode in group]) if group else np.nan
            row.append(f'{final.mean():.3f} ± {final.std(ddof=1):.3f} ({mean:.3f})' if len(group) > 1 else '')
        if any(row[1:]):
            rows.append(row)
    print_table(('', *map(label, conditions)), rows)


def print_tests(cells: dict[tuple[str, Condition], Pair], others: dict[tuple[str, Condition], str]) -> None:
    """A row for each cell."""
    compared = {cell: pair for cell, pair in cells.items() if len(pair[0]) > 1}
    paired = holm([paired_p(*pair) for pair in compared.values()])
    ranked = holm([float(mannwhitneyu(*pair, alternative='greater').pvalue) for pair in compared.values()])
    rows = []
    for (cell, (ours, theirs)), p, u in zip(compared.items(), paired, ranked, strict=True):
        difference = ours - theirs
        error = difference.std(ddof=1) / np.sqrt(len(difference))
        row = f'{ours.mean():.3f}', f'{theirs.mean():.3f}', f'{difference.mean():+.3f} ± {error:.3f}'
        rows.append((cell[0], label(cell[1]), f'`{others[cell]}`', *row, f'{p:.4f}', f'{u:.4f}'))
    print_table(('task', '', 'against', 'ours', 'theirs', 'difference, its error', 'Wilcoxon', 'Mann-Whitney'), rows)


def print_averages(results: Results, strategy: str) -> None:
    """Against every other strategy, each sample's mean over the conditions; p-values uncorrected."""
    rows = []
    for task in results.tasks:
        for other in results.strategies:
            pairs = [pair_of(results, task, condition, strategy, other) for condition in results.conditions(task)]
            if other == strategy or min(len(pair[0]) for pair in pairs) < 2:
                continue
            ours, theirs = (np.mean([pair[side] for pair in pairs], axis=0) for side in (0, 1))
            p = paired_p(ours, theirs)
            u = float(mannwhitneyu(ours, theirs, alternative='greater').pvalue)
            rows.append(
                (task, f'`{other}`', len(ours), f'{ours.mean():.3f}', f'{theirs.mean():.3f}', f'{p:.4f}', f'{u:.4f}')
            )
    print_table(('task', 'against', 'samples', 'ours', 'theirs', 'Wilcoxon', 'Mann-Whitney'), rows)


def print_table(columns: Sequence[object], rows: Sequence[Sequence[object]]) -> None:
    """As a page of the docs holds it."""
    for row in (columns, ['---'] * len(columns), *rows):
        print(f'| {" | ".join(map(str, row))} |')


def label(condition: Condition) -> str:
    """C1 to C4, if it is one of them."""
    return next((name for name, value in PAPER_CONDITIONS.items() if value == condition), str(condition))


if __name__ == '__main__':
    main()
