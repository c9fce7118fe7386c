"""Figures of the paper, and three more: questioning behaviour, query kinds, and accuracy by cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from al_questioner.domain import QueryKind
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_STRATEGIES,
    PROPOSED,
    Cell,
    Condition,
    task_label,
)
from al_questioner.experiments.results import Results
from al_questioner.experiments.statistics import mean_and_error
from al_questioner.questioning.candidates import BUDGET_ROUNDING
from al_questioner.support.plotting import (
    KIND_COLOURS,
    STYLE,
    colours_of,
    kind_name,
    mark_changes,
    new_figure,
    put_legend_below,
    save,
)
from al_questioner.support.text import number_of

COLOURS = {
    'dt_task_env': '#c1272d',
    'dt_task': '#2c6fbb',
    'dt_iros': '#3a923a',
    'u_sampling': '#000000',
    'value_per_cost': '#e6007e',
    'u_sampling_fsq': '#777777',
    'random_fsq': '#b8860b',
    'farthest_fsq': '#8e44ad',
    'rarest_demo': '#d1622b',
    'typiclust': '#1f9e9e',
    'probcover': '#7a5230',
    'all_labels': '#9a9a9a',
    'greedy_oracle': '#00838f',
}


LONG = 40
"""Number of turns above which the paper shows the questioning behaviour."""


def draw_figures(
    results: Results, change_intervals: Mapping[str, int], folder: Path, compared: str | None = None
) -> list[Path]:
    """Write all figures of all tasks and return their paths.

    Args:
        results: of the experiment.
        change_intervals: turns between changes of the scene, by task.
        folder: where the figures go.
        compared: the strategy that the figures are about.

    Raises:
        InputError: a picture cannot be written.
    """
    paths = []
    with rc_context(STYLE):
        for task in results.tasks:
            name = task_label(task)
            paths.append(save(learning_curves(results, task, compared), folder / f'learning_curves_{name}.png'))
            paths.append(_behaviour(results, task, change_intervals[task], folder / f'behaviour_{name}.png'))
            paths.append(_kinds(results, task, folder / f'queries_{name}.png'))
            paths.append(_budget(results, task, folder / f'budget_{name}.png'))
            paths.append(draw_cost_curves(results, task, folder))
    return paths


def _conditions(results: Results, task: str) -> list[Condition]:
    """Return the conditions in the layout of the paper: budget rises upwards, time to the right."""
    return sorted(results.conditions(task), key=lambda condition: (-condition.budget, condition.turns))


def _panels(
    results: Results, task: str, height: float, same_scale: bool = False
) -> tuple[Figure, list[tuple[Axes, Condition]]]:
    """Return a figure with a panel for each condition, two in a row."""
    conditions = _conditions(results, task)
    columns = min(2, len(conditions))
    rows = -(-len(conditions) // columns)
    figure = new_figure(5.2 * columns, height * rows)
    axes = figure.subplots(rows, columns, sharey=same_scale, squeeze=False)
    for panel in axes.flat[len(conditions) :]:
        panel.set_axis_off()
    panels = list(zip(axes.flat, conditions, strict=False))
    for panel, condition in panels:
        panel.set_title(results.name_of(condition), loc='left', fontsize=10)
    figure.suptitle(f'{task}, {number_of(len(results.samples), "sample")}', x=0.01, ha='left', fontsize=11)
    return figure, panels


def _finish(figure: Figure, columns: int, path: Path) -> Path:
    """Save a figure with the legend of its first panel below."""
    _add_legend(figure, columns)
    return save(figure, path)


def _add_legend(figure: Figure, columns: int) -> None:
    """Put the legend of a figure's first panel below, in fewer columns if they would not fit."""
    put_legend_below(figure, columns, *figure.axes[0].get_legend_handles_labels())


def _line(strategy: str) -> dict[str, Any]:
    """Return the style of a strategy's line.

    It is solid for the strategies of the paper and ours, dashed for controls, and dotted for ceilings.
    """
    style = '--' if strategy in CONTROLS else ':' if strategy in CEILINGS else '-'
    width = 2.6 if strategy in PROPOSED else 1.6
    return {'color': COLOURS.get(strategy), 'linestyle': style, 'linewidth': width, 'label': strategy}


def strategies_with_bands(results: Results, compared: str | None = None) -> list[str]:
    """Return the strategies whose standard error the learning curves show: more bands would not be readable.

    It is the one that they are about, and those of the paper.
    """
    return [name for name in results.strategies if name == compared or name in PAPER_STRATEGIES]


def learning_curves(results: Results, task: str, compared: str | None = None) -> Figure:
    """Draw accuracy after each turn, with the standard error of some strategies."""
    with_bands = strategies_with_bands(results, compared)
    with rc_context(STYLE):
        figure, panels = _panels(results, task, 3.6, same_scale=True)
        for panel, condition in panels:
            for strategy in results.strategies:
                curves = results.curves(task, condition, strategy)
                if not len(curves):
                    continue
                mean, error = mean_and_error(curves)
                turns = np.arange(1, len(mean) + 1)
                (line,) = panel.plot(turns, mean, marker='o' if len(mean) == 1 else None, **_line(strategy))
                if strategy in with_bands:
                    low, high = mean - error, mean + error
                    panel.fill_between(turns, low, high, color=line.get_color(), alpha=0.15, linewidth=0)
            panel.set(xlabel='turn', ylabel='accuracy', ylim=(0, 1), xlim=(0, max(condition.turns, 2)))
            panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        _add_legend(figure, 4)
        return figure


def _behaviour(results: Results, task: str, change_interval: int, path: Path) -> Path:
    """Draw the queries of each strategy over time, in the first sample."""
    conditions = _conditions(results, task)
    conditions = [condition for condition in conditions if condition.turns > LONG] or conditions[-1:]
    strategies = _askers(results)
    height = 0.34 * len(strategies) + 0.9
    figure = new_figure(10, height * len(conditions) + 0.7)
    axes = figure.subplots(len(conditions), 1, squeeze=False)
    for panel, condition in zip(axes.flat, conditions, strict=True):
        for row, strategy in enumerate(strategies):
            cell = Cell(task, condition.budget, condition.turns, strategy, results.samples[0])
            _draw_queries(panel, results, cell, -row)
        mark_changes(panel, list(range(1 + change_interval, condition.turns + 1, change_interval)))
        panel.set_yticks([-row for row in range(len(strategies))], strategies, fontsize=9)
        panel.set(xlim=(0, condition.turns + 1), ylim=(0.6 - max(len(strategies), 1), 0.6), xlabel='turn')
        panel.xaxis.set_major_locator(MaxNLocator(integer=True))
        panel.set_title(results.name_of(condition), loc='left', fontsize=10)
    figure.suptitle(f'{task}, sample {results.samples[0]}', x=0.01, ha='left', fontsize=11)
    shown = _colours(results, task)
    for kind, colour in shown.items():
        axes.flat[0].scatter([], [], color=colour, s=24, label=f'{kind_name(kind)} query')
    return _finish(figure, len(shown), path)


def _colours(results: Results, task: str) -> Mapping[QueryKind, str]:
    """Return the colours of the kinds of queries that the figures of a task show."""
    cells = [row.cell for row in results.episodes if row.cell.task == task]
    return colours_of(QueryKind(turn.kind) for cell in cells for turn in results.turns_of(cell))


def _draw_queries(axes: Axes, results: Results, cell: Cell, height: float) -> None:
    for kind, colour in KIND_COLOURS.items():
        turns = [turn.turn for turn in results.turns_of(cell) if turn.kind == kind.value]
        axes.scatter(turns, [height] * len(turns), color=colour, s=16, zorder=3, linewidth=0)


def _kinds(results: Results, task: str, path: Path) -> Path:
    """Draw the number of queries of each kind, mean over the samples."""
    figure, panels = _panels(results, task, 3.0)
    strategies, shown = _askers(results), _colours(results, task)
    positions = -np.arange(len(strategies))
    for panel, condition in panels:
        left = np.zeros(len(strategies))
        for kind, colour in shown.items():
            counts = np.array([_mean_count(results, task, condition, name, kind) for name in strategies])
            panel.barh(positions, counts, left=left, color=colour, label=kind_name(kind))
            left += counts
        panel.set_yticks(positions, strategies, fontsize=9)
        panel.set_xlabel('queries')
    return _finish(figure, len(shown), path)


def _mean_count(results: Results, task: str, condition: Condition, strategy: str, kind: QueryKind) -> float:
    group = results.group(task, condition, strategy)
    counts = [sum(turn.kind == kind.value for turn in results.turns_of(row.cell)) for row in group]
    return float(np.mean(counts)) if counts else 0.0


def _budget(results: Results, task: str, path: Path) -> Path:
    """Draw the share of the budget spent over time, mean over the samples."""
    figure, panels = _panels(results, task, 3.0, same_scale=True)
    for panel, condition in panels:
        for strategy in _askers(results):
            spent = _spent(results, task, condition, strategy)
            if len(spent):
                share = spent.mean(axis=0) / (condition.budget or 1)
                panel.step(np.arange(1, len(share) + 1), share, where='post', **_line(strategy))
        panel.set(xlabel='turn', ylabel='share of budget spent', ylim=(0, 1.02), xlim=(0, condition.turns))
        panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    return _finish(figure, 4, path)


def draw_cost_curves(results: Results, task: str, folder: Path) -> Path:
    """Write how accurate the strategies are for what they have spent, mean over the samples.

    A line ends at the mean of what is spent in the end.

    Raises:
        InputError: the picture cannot be written.
    """
    with rc_context(STYLE):
        figure, panels = _panels(results, task, 3.6, same_scale=True)
        for panel, condition in panels:
            for strategy in _askers(results):
                curves, spent = results.curves(task, condition, strategy), _spent(results, task, condition, strategy)
                if len(curves):
                    costs = np.linspace(0, spent[:, -1].mean(), 101)
                    panel.plot(costs, accuracy_by_cost(curves, spent, costs).mean(axis=0), **_line(strategy))
            panel.set(xlabel='spent', ylabel='accuracy', ylim=(0, 1), xlim=(0, None))
        return _finish(figure, 4, folder / f'accuracy_by_cost_{task_label(task)}.png')


def accuracy_by_cost(curves: np.ndarray, spent: np.ndarray, costs: np.ndarray) -> np.ndarray:
    """Return (n, k) accuracy at the end of the last turn with at most each cost spent; of the first turn, if none.

    Args:
        curves: (n, T) accuracy after each turn.
        spent: (n, T) spent by the end of it.
        costs: (k,) in ascending order.
    """
    turns = [np.searchsorted(row, costs + BUDGET_ROUNDING, side='right') for row in spent]
    return np.array([row[np.maximum(turn - 1, 0)] for row, turn in zip(curves, turns, strict=True)])


def _askers(results: Results) -> list[str]:
    """Return the strategies that ask; `all_labels` learns without asking."""
    return [name for name in results.strategies if name != 'all_labels']


def _spent(results: Results, task: str, condition: Condition, strategy: str) -> np.ndarray:
    group: Sequence[Cell] = [row.cell for row in results.group(task, condition, strategy)]
    return np.array([[turn.spent for turn in results.turns_of(cell)] for cell in group])
