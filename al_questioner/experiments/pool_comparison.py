"""Comparison of strategies on a user's own data: plan, tests and pictures of an experiment, without its folder."""

from __future__ import annotations

import base64
import dataclasses
import html
import itertools
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from al_questioner.domain import BUDGET, TURNS, Costs, SettingsError
from al_questioner.domain.names import listed
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.figures import draw_figures, learning_curves
from al_questioner.experiments.findings import others_than
from al_questioner.experiments.plan import Cell, Condition, Plan, Variation
from al_questioner.experiments.playing import Played, play_in, rows_of
from al_questioner.experiments.processes import do_in_processes
from al_questioner.experiments.report import ABOUT_ACCURACIES, Table, accuracy_table, comparison_table
from al_questioner.experiments.results import Results, results_of
from al_questioner.experiments.statistics import Comparison
from al_questioner.experiments.statistics import compare as compare_accuracies
from al_questioner.simulation import Pool, PoolWorld
from al_questioner.support.arrays import Array
from al_questioner.support.plotting import picture_of


@dataclass(frozen=True, eq=False)
class PoolComparison:
    """Result of a comparison on a pool. `print` shows its tables, and a notebook its learning curves too.

    Attributes:
        results: every episode and turn; a sample is the number of a split.
        strategies: names in the order in which they were given.
        change_interval: turns between scene changes.
    """

    results: Results
    strategies: tuple[str, ...]
    change_interval: int

    @property
    def name(self) -> str:
        """Name of the pool."""
        return self.results.tasks[0]

    @property
    def compared(self) -> str | None:
        """Name of the strategy that is tested against the others: the first; None where only ceilings were played."""
        return next((name for name in self.strategies if name not in CEILINGS), None)

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """Budgets with their number of turns, in the order in which they were given."""
        return self.results.conditions(self.name)

    def accuracies(self, budget: float | None = None) -> dict[str, Array]:
        """Return the (repeats,) accuracies at the end by strategy, all in the same order of splits.

        Raises:
            InputError: a budget that was not played, or none where several were.
        """
        found = self.results.final_accuracies(self.name, self._condition(budget))
        return {strategy: found[strategy] for strategy in self.strategies}

    def against(self, strategy: str | None = None, budget: float | None = None) -> list[Comparison]:
        """Return the tests whether a strategy, the first if none is named, is more accurate than each other one.

        Raises:
            InputError: a strategy or a budget that was not played, or no budget where several were, or a ceiling.
        """
        name = self.compared if strategy is None else strategy
        if name is None or name in CEILINGS:
            raise SettingsError(f'{name or "what was played"} knows the truth, and is not tested against strategies')
        accuracies = self.accuracies(budget)
        if name not in accuracies:
            raise SettingsError(f'strategy {name!r} was not played; played were: {", ".join(self.strategies)}')
        others = {other: found for other, found in accuracies.items() if other != name and other not in CEILINGS}
        return compare_accuracies(accuracies[name], others)

    def figure(self) -> Figure:
        """Return the learning curves, a panel for each budget."""
        return learning_curves(self.results, self.name, self.compared)

    def draw(self, folder: Path | str) -> list[Path]:
        """Write the figures of an experiment into a folder, and return their paths.

        Raises:
            InputError: a picture cannot be written.
        """
        return draw_figures(self.results, {self.name: self.change_interval}, Path(folder), self.compared)

    def __str__(self) -> str:
        accuracies = accuracy_table(self.results, self.name)
        texts = [f'{ABOUT_ACCURACIES}\n', *_aligned(accuracies)]
        first = self.compared
        if first is not None and others_than(first, self.results):
            about = (
                f'Is {first} more accurate? One-tailed tests: Mann-Whitney U, and, as all share the splits, Wilcoxon:'
            )
            texts += ['', f'{about}\n', *_aligned(comparison_table(self.results, self.name, first))]
        return '\n'.join(texts)

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        """Return the tables and the learning curves, as notebooks show them."""
        picture = base64.b64encode(picture_of(self.figure())).decode()
        return f'<pre>{html.escape(str(self))}</pre><img width="800" src="data:image/png;base64,{picture}">'

    def _condition(self, budget: float | None) -> Condition:
        chosen = [each for each in self.conditions if budget is None or each.budget == budget]
        if len(chosen) != 1:
            played = ', '.join(f'{each.budget:g}' for each in self.conditions)
            missing = 'name a budget' if budget is None else f'budget {budget:g} was not played'
            raise SettingsError(f'{missing}; played were: {played}')
        return chosen[0]


def compare(
    strategies: Sequence[str],
    pool: Pool,
    budgets: float | Sequence[float] = BUDGET.default,
    costs: Costs | None = None,
    repeats: int = 20,
    *,
    turns: int = TURNS.default,
    relevant_groups: Sequence[str] = (),
    in_view: int = 20,
    change_interval: int = 10,
    test_share: float = 0.5,
    wrong_rate: float = 0.0,
    unknown_rate: float = 0.0,
    first_split: int = 0,
    name: str = 'pool',
    jobs: int = 1,
    watch: Callable[[Played], None] | None = None,
) -> PoolComparison:
    """Compare strategies on a pool, as `experiment` does on tables, and return what came of it.

    Every strategy plays an episode with every budget on the same splits of the pool into things that are shown and
    things that are held out. The scripted teacher answers from the labels of the pool. See `PoolWorld` for the table.

    Args:
        strategies: names; the first one is tested against the others. `all_labels` is a ceiling: it is told all, and
            not tested.
        pool: the things.
        budgets: query budget, or several.
        costs: of each kind of query; those of the paper if not given.
        repeats: number of splits.
        turns: length of an episode.
        relevant_groups: groups of features that the teacher calls relevant; all if none are given.
        in_view: things on the table at a time.
        change_interval: turns from one change of the table to the next.
        test_share: share of the things that is held out.
        wrong_rate: share of the teacher's answers that are wrong.
        unknown_rate: share of the queries that the teacher has no answer to.
        first_split: number of the first split, which is also the seed of its episodes.
        name: name of the pool in tables and pictures.
        jobs: number of processes.
        watch: called with each episode that was played.

    Raises:
        EpisodeError: a process died.
        InputError: an unknown strategy, a number out of its range, or a pool that does not fit the table.
    """
    names = listed(strategies)
    if names is None:
        raise SettingsError(f'strategies must be a list of names, not {strategies!r}')
    for number, what in ((repeats, 'repeats'), (jobs, 'jobs')):
        if not isinstance(number, int) or number < 1:
            raise SettingsError(f'{what} must be a whole number of 1 or more, not {number!r}')
    plan = _PoolPlan(
        (name,),
        tuple(Condition(budget, turns) for budget in np.ravel(budgets).tolist()),
        names,
        tuple(range(first_split, first_split + repeats)),
        Variation(wrong_rate=wrong_rate, unknown_rate=unknown_rate),
    )
    groups = tuple(relevant_groups)
    worlds = {
        split: PoolWorld(pool, split, in_view, change_interval, test_share, groups, name, costs or Costs())
        for split in plan.samples
    }
    groups_of_cells = list(plan.groups())
    work = ((cells, worlds[cells[0].sample], plan.variation) for cells in groups_of_cells)
    found: dict[Cell, Played] = {}
    for played in itertools.chain.from_iterable(do_in_processes(_play, work, jobs, 'try fewer jobs')):
        found[played.cell] = played
        if watch is not None:
            watch(played)
    in_order = [found[cell] for cell in itertools.chain.from_iterable(groups_of_cells)]
    results = results_of([each.episode for each in in_order], [row for each in in_order for row in each.turns])
    # Whose data are not the paper's need not know its numbers of conditions.
    return PoolComparison(dataclasses.replace(results, numbered=False), plan.strategies, change_interval)


class _PoolPlan(Plan):
    """Plan whose task is a pool in the memory of this program."""

    def _check_tasks(self) -> None:
        for condition in self.conditions:
            BUDGET.check(condition.budget)
            TURNS.check(condition.turns)


def _play(cells: Sequence[Cell], world: PoolWorld, variation: Variation) -> list[Played]:
    """Play the cells of a split."""
    return list(_played(cells, world, variation))


def _played(cells: Sequence[Cell], world: PoolWorld, variation: Variation) -> Iterator[Played]:
    for cell in cells:
        began = time.monotonic()
        played = rows_of(cell, play_in(world.spec, world, cell, variation))
        yield dataclasses.replace(played, seconds=time.monotonic() - began)


def _aligned(table: Table) -> list[str]:
    """Return the lines of a table whose columns stand below each other."""
    lines = [[text.replace('`', '') for text in line] for line in (table[0], *table[1])]
    widths = [max(map(len, column)) for column in zip(*lines, strict=True)]
    return ['  '.join(map(str.ljust, line, widths)).rstrip() for line in lines]
