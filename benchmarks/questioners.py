"""Worth of a questioner beside the others: tables, tests and the figure of accuracy against cost.

    python benchmarks/questioners.py [VARIANT=]FOLDER ... [--strategy NAME] [--figures DIR] [--page FILE]

Each folder is the --out of an experiment; together they hold the episodes of all strategies that are compared, each
once, on the same samples. Where a variant is named, the strategies of that folder are called STRATEGY, VARIANT. A cell
is a task in a condition. Printed are, by cell, the accuracy at the end of the time and its mean over the turns, with
the standard deviation over the samples; then the differences to each strategy of the paper, to the best control and to
each variant, with one-tailed p-values of Wilcoxon's signed-rank test and of the Mann-Whitney U test, both corrected by
Holm's method over all cells; then both averaged over the conditions, for each task. A page holds the same.
"""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from al_questioner.domain import InputError
from al_questioner.experiments.figures import draw_cost_curves
from al_questioner.experiments.plan import CONTROLS, PAPER_CONDITIONS, PAPER_STRATEGIES, Condition
from al_questioner.experiments.plan import Cell as CellOfExperiment
from al_questioner.experiments.results import EpisodeRow, Results, read_results
from al_questioner.experiments.statistics import best_of, holm, paired_p, u_test
from al_questioner.support.arrays import Array
from al_questioner.support.files import write_bytes

VARIANT = ', '
"""Separator of the name of a strategy and that of its variant."""
PAGE_HEAD = """\
# Tables of the questioners

The tables of [questioner.md](questioner.md), which says what they tell and by which commands they were made. A cell is
a task in a condition, C1 to C4. First the accuracy at the end of the time, mean and standard deviation over the
samples, and in brackets its mean over the turns. Then one-tailed tests that the first strategy is the more accurate one
at the end of the time: Wilcoxon's signed-rank test on the pairs, and the Mann-Whitney U test, which does not know that
they are pairs, each corrected by Holm's method over the cells; the difference is with its standard error. At last the
same for the mean over the four conditions, the p-values uncorrected."""


class Cell(NamedTuple):
    """A task in a condition, in which strategies are compared over the samples."""

    task: str
    condition: Condition


def main() -> int:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('folders', nargs='+', metavar='[VARIANT=]FOLDER')
    parser.add_argument('--strategy', default='value_per_cost')
    parser.add_argument('--figures', type=Path)
    parser.add_argument('--page', type=Path, metavar='FILE', help='write the tables as a page of the docs')
    given = parser.parse_args()
    try:
        results = read_together(given.folders)
        lines = list(lines_of(results, given.strategy))
        print(*lines, sep='\n')
        if given.page:
            write_bytes(given.page, '\n'.join([PAGE_HEAD, *lines, '']).encode())
        if given.figures:
            common = on_common_samples(without_variants(results))
            print(*(draw_cost_curves(common, task, given.figures) for task in common.tasks), sep='\n')
    except InputError as error:
        print(f'questioners: {error}', file=sys.stderr)
        return 2
    return 0


def read_together(folders: Sequence[str]) -> Results:
    """Read the tables of several experiments as if they were one; each is FOLDER, or VARIANT=FOLDER.

    Raises:
        InputError: a table is missing or is none of an experiment, or a folder holds an episode of one before it.
    """
    together = Results([], [])
    for folder in folders:
        variant, _, path = folder.rpartition('=')
        found = read_results(Path(path))
        if variant:
            found = renamed(found, variant)
        twice = {row.cell for row in together.episodes} & {row.cell for row in found.episodes}
        if twice:
            raise InputError(f'{folder}: an episode is there twice: {min(twice)}')
        together = Results([*together.episodes, *found.episodes], [*together.turns, *found.turns])
    return together


def renamed(results: Results, variant: str) -> Results:
    """The same results of strategies that bear the name of a variant."""
    return Results(
        *(
            [replace(row, cell=variant_of(row.cell, variant)) for row in rows]
            for rows in (results.episodes, results.turns)
        )
    )


def variant_of(cell: CellOfExperiment, variant: str) -> CellOfExperiment:
    """The cell of a variant of the strategy."""
    return replace(cell, strategy=f'{cell.strategy}{VARIANT}{variant}')


def without_variants(results: Results) -> Results:
    """The results of the strategies themselves: more lines would not be told apart in a figure."""
    return Results(
        *([row for row in rows if VARIANT not in row.cell.strategy] for rows in (results.episodes, results.turns))
    )


def variants_of(results: Results) -> list[str]:
    """The names of the variants, in the order of the folders."""
    return list(dict.fromkeys(name.split(VARIANT, 1)[1] for name in results.strategies if VARIANT in name))


def of_variant(results: Results, variant: str) -> Results:
    """The results of the strategies of a variant."""
    return Results(
        *(
            [row for row in rows if row.cell.strategy.endswith(VARIANT + variant)]
            for rows in (results.episodes, results.turns)
        )
    )


def lines_of(results: Results, strategy: str) -> Iterator[str]:
    """All tables about a strategy, in Markdown.

    Raises:
        InputError: it was not played, or no control was in one of the cells.
    """
    if strategy not in results.strategies:
        raise InputError(f'{strategy} was not played; played were {", ".join(results.strategies)}')
    cells = cells_of(results, results.tasks)
    best = {cell: best_control(results, cell) for cell in cells}
    alike = on_common_samples(without_variants(results))
    for task in results.tasks:
        yield from ('', f'## {task}, {len(alike.samples)} samples', '')
        yield from accuracies(alike, task)
    for variant in variants_of(results):
        varied = on_common_samples(of_variant(results, variant))
        for task in varied.tasks:
            yield from ('', f'## {task}, {variant}, {len(varied.samples)} samples', '')
            yield from accuracies(varied, task)
    variants = [name for name in results.strategies if name.startswith(strategy + VARIANT)]
    for other in (*(name for name in PAPER_STRATEGIES if name in results.strategies), *variants):
        yield from ('', f'## {strategy} against {other}', '')
        yield from tests(results, strategy, dict.fromkeys(cells, other))
    yield from ('', f'## {strategy} against the best control of each cell', '')
    yield from tests(results, strategy, best)
    yield from ('', '## Mean over the conditions, of each sample', '')
    yield from averages(results, strategy)


def cells_of(results: Results, tasks: Iterable[str]) -> list[Cell]:
    """The cells of some tasks."""
    return [Cell(task, condition) for task in tasks for condition in results.conditions(task)]


def on_common_samples(results: Results) -> Results:
    """The part about those samples that every strategy has in every cell in which it was played."""
    samples: dict[tuple[Cell, str], set[int]] = defaultdict(set)
    for row in results.episodes:
        samples[Cell(row.cell.task, row.cell.condition), row.cell.strategy].add(row.cell.sample)
    return results.of_samples(set.intersection(*samples.values()))


def best_control(results: Results, cell: Cell) -> str:
    """The control of largest mean accuracy.

    Raises:
        InputError: no control was played in the cell.
    """
    means = {name: mean for name in CONTROLS if (mean := results.mean_accuracy(*cell, name)) is not None}
    if not means:
        raise InputError(f'{cell.task}, {cell.condition}: no control was played, of {", ".join(CONTROLS)}')
    return best_of(means)


def accuracies_of_both(results: Results, cells: Sequence[Cell], first: str, other: str) -> tuple[Array, Array]:
    """(n,) accuracies of two strategies, averaged over cells, of the n samples that both have in all of these."""
    ours, theirs = (
        [{row.cell.sample: row.final_accuracy for row in results.group(*cell, name)} for cell in cells]
        for name in (first, other)
    )
    samples = sorted(set.intersection(*map(set, (*ours, *theirs))))

    def averages(by_cell: Sequence[Mapping[int, float]]) -> Array:
        return np.mean([[accuracies[sample] for sample in samples] for accuracies in by_cell], axis=0)

    return averages(ours), averages(theirs)


def accuracies(results: Results, task: str) -> Iterator[str]:
    """Accuracy at the end, and in brackets its mean over the turns; strategies of one sample have no row."""
    conditions = results.conditions(task)
    rows = {name: [accuracy_text(results.group(task, c, name)) for c in conditions] for name in results.strategies}
    yield from table(
        ('', *map(condition_label, conditions)), [(f'`{name}`', *texts) for name, texts in rows.items() if any(texts)]
    )


def accuracy_text(episodes: Sequence[EpisodeRow]) -> str:
    """Mean, deviation and mean over the turns; nothing of less than two samples."""
    if len(episodes) < 2:
        return ''
    final = np.array([episode.final_accuracy for episode in episodes])
    over_turns = np.mean([episode.mean_accuracy for episode in episodes])
    return f'{final.mean():.3f} ± {final.std(ddof=1):.3f} ({over_turns:.3f})'


def tests(results: Results, strategy: str, others: Mapping[Cell, str]) -> Iterator[str]:
    """A row for each cell, in which the strategy is compared with the other one that is named there."""
    pairs = {cell: accuracies_of_both(results, [cell], strategy, other) for cell, other in others.items()}
    pairs = {cell: pair for cell, pair in pairs.items() if len(pair[0]) > 1}
    wilcoxon = holm([paired_p(*pair) for pair in pairs.values()])
    mann_whitney = holm([u_test(*pair)[1] for pair in pairs.values()])
    rows = []
    for (cell, (ours, theirs)), p, u in zip(pairs.items(), wilcoxon, mann_whitney, strict=True):
        difference = ours - theirs
        error = difference.std(ddof=1) / np.sqrt(len(difference))
        what = cell.task, condition_label(cell.condition), f'`{others[cell]}`', len(difference)
        means = f'{ours.mean():.3f}', f'{theirs.mean():.3f}', f'{difference.mean():+.3f} ± {error:.3f}'
        rows.append((*what, *means, f'{p:.4f}', f'{u:.4f}'))
    yield from table(
        ('task', '', 'against', 'samples', 'ours', 'theirs', 'difference, its error', 'Wilcoxon', 'Mann-Whitney'), rows
    )


def averages(results: Results, strategy: str) -> Iterator[str]:
    """Against every other strategy, each sample's mean over the conditions; p-values uncorrected."""
    rows = []
    for task in results.tasks:
        for other in (name for name in results.strategies if name != strategy):
            ours, theirs = accuracies_of_both(results, cells_of(results, [task]), strategy, other)
            if len(ours) > 1:
                means = f'{ours.mean():.3f}', f'{theirs.mean():.3f}'
                tests = f'{paired_p(ours, theirs):.4f}', f'{u_test(ours, theirs)[1]:.4f}'
                rows.append((task, f'`{other}`', len(ours), *means, *tests))
    yield from table(('task', 'against', 'samples', 'ours', 'theirs', 'Wilcoxon', 'Mann-Whitney'), rows)


def table(columns: Sequence[object], rows: Sequence[Sequence[object]]) -> Iterator[str]:
    """A table as a page of the docs holds it."""
    for row in (columns, ['---'] * len(columns), *rows):
        yield f'| {" | ".join(map(str, row))} |'


def condition_label(condition: Condition) -> str:
    """C1 to C4, if it is one of them."""
    return next((name for name, paper in PAPER_CONDITIONS.items() if paper == condition), str(condition))


if __name__ == '__main__':
    sys.exit(main())
