"""Pictures of a training: the gap of the feature counts, and the queries of expert and learner over time."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from al_questioner.domain import QueryRecord
from al_questioner.imitation.demonstration import Demonstration
from al_questioner.imitation.max_entropy_irl import WINDOW, mean_gaps
from al_questioner.imitation.training import Training
from al_questioner.support.plotting import (
    STYLE,
    colours_of,
    kind_name,
    mark_changes,
    mark_query,
    new_figure,
    put_legend_below,
    save,
)


def draw_training(
    training: Training, demonstrations: Sequence[Demonstration], learner: Sequence[Sequence[QueryRecord]], path: Path
) -> Path:
    """Write a picture of the convergence, the weights, and the timelines: the expert's and the learner's.

    Raises:
        InputError: it cannot be written.
    """
    with rc_context(STYLE):
        height = 3.2 + 0.75 * len(demonstrations) + 0.8
        figure = new_figure(11, height)
        grid = figure.add_gridspec(2, 2, height_ratios=(3.2, height - 3.2))
        _draw_convergence(figure.add_subplot(grid[0, 0]), training)
        _draw_weights(figure.add_subplot(grid[0, 1]), training)
        _draw_timelines(figure, figure.add_subplot(grid[1, :]), demonstrations, learner)
        return save(figure, path)


def _draw_convergence(axes: Axes, training: Training) -> None:
    matching = training.matching
    if matching is None:
        names = [name.replace('_', ' ') for name in training.by_feature(training.gap_before)]
        rows = np.arange(len(names))
        axes.barh(rows - 0.2, np.abs(training.gap_before), height=0.4, color='lightgray', label='before')
        axes.barh(rows + 0.2, np.abs(training.gap_after), height=0.4, color='black', label='after')
        axes.set_yticks(rows, names, fontsize=9)
        axes.invert_yaxis()
        axes.set_xlabel("gap at the expert's steps (scales)")
        axes.legend(frameon=False)
        return
    numbers = np.arange(1, len(matching.iterations) + 1)
    axes.plot(numbers, [np.linalg.norm(i.gap) for i in matching.iterations], color='#2c6fbb', label='training')
    if training.validation:
        held_out = [np.linalg.norm(i.validation_gap) for i in matching.iterations]
        axes.plot(numbers, held_out, color='#d1622b', alpha=0.5, label='validation')
        smoothed = [mean_gaps(matching.iterations, last)[1] for last in range(len(numbers))]
        axes.plot(numbers, smoothed, color='#d1622b', linewidth=2, label=f'validation, mean of {WINDOW}')
    axes.axvline(matching.kept + 1, color='black', linestyle=':', label='kept')
    axes.set(xlabel='iteration', ylabel='feature-count gap (scales)', ylim=(0, None))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.legend(frameon=True, framealpha=1, edgecolor='none', fontsize=9)


def _draw_weights(axes: Axes, training: Training) -> None:
    named = training.by_feature(training.weights)
    rows = np.arange(len(named))
    free = training.free.unidentified
    axes.barh(rows, list(named.values()), color=['lightgray' if name in free else 'black' for name in named])
    labels = [name.replace('_', ' ') + (' (not identified)' if name in free else '') for name in named]
    axes.set_yticks(rows, labels, fontsize=9)
    axes.invert_yaxis()
    axes.axvline(0, color='gray', linewidth=0.8)
    axes.set_xlabel('weight')


def _draw_timelines(
    figure: Figure, axes: Axes, demonstrations: Sequence[Demonstration], learner: Sequence[Sequence[QueryRecord]]
) -> None:
    """Two rows for each demonstration, the expert's above the learner's."""
    ticks: list[tuple[float, str]] = []
    for number, demonstration in enumerate(demonstrations):
        rows = [(f'expert, {demonstration.name}', demonstration.queries), ('learner', learner[number])]
        for offset, (label, queries) in enumerate(rows):
            height = -(number + 0.42 * offset)
            ticks.append((height, label))
            for record in queries:
                mark_query(axes, record, height)
    mark_changes(axes, demonstrations[0].change_turns)
    shown = colours_of(record.kind for demonstration in demonstrations for record in demonstration.queries)
    for kind, colour in shown.items():
        axes.scatter([], [], color=colour, s=40, label=f'{kind_name(kind)} query')
    axes.set_yticks([height for height, _ in ticks], [label for _, label in ticks], fontsize=9)
    axes.set(
        xlabel='turn', xlim=(0, max(d.settings.turns for d in demonstrations) + 1), ylim=(-len(demonstrations), 0.5)
    )
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    put_legend_below(figure, len(shown), *axes.get_legend_handles_labels(), fontsize=9)
