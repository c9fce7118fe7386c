"""Pictures of an episode: its learning curve, its timeline, and a scene with what was asked about."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from al_questioner.commands.demo.new_table import NewTable
from al_questioner.domain import NO_SYMBOL, Outcome, QueryRecord, RecognisedThing
from al_questioner.simulation import EpisodeResult, PerceivedWorld
from al_questioner.simulation.kitchen.table_image import Mark, draw_scene
from al_questioner.support.plotting import (
    KIND_COLOURS,
    STYLE,
    colours_of,
    kind_name,
    mark_changes,
    mark_query,
    new_figure,
    put_legend_below,
    save,
)
from al_questioner.support.text import number_of

RIGHT, WRONG, NOT_KNOWN = (0, 130, 60), (205, 30, 40), (110, 110, 110)
"""Colours of a mark: red, green, blue in 0..255."""


def draw_pictures(
    result: EpisodeResult, new_table: NewTable, world: PerceivedWorld, folder: Path, views: str = 'images'
) -> list[Path]:
    """Write the pictures of an episode.

    They are `learning_curve.png`, `timeline.png` and, if the views of the world's things are images, `scene.png` and
    `new_table.png`.

    Returns:
        Their paths.

    Raises:
        InputError: one cannot be written.
    """
    with rc_context(STYLE):
        figures = {'learning_curve': _learning_curve(result, views), 'timeline': _timeline(result, world)}
        if views == 'images':
            figures['scene'] = _scene(result, world)
            figures['new_table'] = _new_table(result, new_table)
        return [save(figure, folder / f'{name}.png') for name, figure in figures.items()]


def _learning_curve(result: EpisodeResult, views: str) -> Figure:
    figure = new_figure(7, 4.2)
    axes = figure.subplots()
    turns = range(1, len(result.accuracy) + 1)
    # From turn to turn it stays as it is, and a single turn is seen too.
    edges = [turn - 0.5 for turn in (*turns, turns[-1] + 1)]
    axes.stairs(result.accuracy, edges, baseline=None, color='black', linewidth=1.8, zorder=2)
    chance = 1 / len(result.settings.symbols)
    axes.axhline(chance, color='gray', linestyle=':', linewidth=1.2)
    axes.annotate('chance', (turns[-1], chance), xytext=(0, 4), textcoords='offset points', ha='right', color='gray')
    for kind, colour in KIND_COLOURS.items():
        asked = [record.turn for record in result.queries if record.kind is kind]
        if asked:
            heights = [result.accuracy[turn - 1] for turn in asked]
            axes.scatter(asked, heights, color=colour, s=26, zorder=3, label=f'{kind_name(kind)} query')
    axes.set(xlabel='turn', ylabel=f'accuracy on held-out {views}', ylim=(0, 1.02), xlim=(0.5, turns[-1] + 0.5))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    axes.set_title(_title(result), loc='left', fontsize=11)
    if result.queries:
        put_legend_below(figure, len(KIND_COLOURS), *axes.get_legend_handles_labels())
    return figure


def _timeline(result: EpisodeResult, world: PerceivedWorld) -> Figure:
    figure = new_figure(9, 4.6)
    asked, budget = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    turns = result.settings.turns
    for axes in (asked, budget):
        mark_changes(axes, world.change_turns(turns))
    rows = {kind: row for row, kind in enumerate(reversed(colours_of(record.kind for record in result.queries)))}
    for record in result.queries:
        mark_query(asked, record, rows[record.kind])
    asked.set_yticks(list(rows.values()), [kind_name(kind) for kind in rows])
    asked.set_ylim(-0.6, len(rows) - 0.4)
    asked.set_title(f'{_title(result)}   (grey lines: the scene changes)', loc='left', fontsize=11)
    spent = [0.0]
    by_turn = {record.turn: record.cost for record in result.queries}
    for turn in range(1, turns + 1):
        spent.append(spent[-1] + by_turn.get(turn, 0.0))
    left = [result.settings.budget - amount for amount in spent]
    budget.xaxis.set_major_locator(MaxNLocator(integer=True, min_n_ticks=1))
    budget.step(range(turns + 1), left, where='post', color='black', linewidth=1.6)
    budget.set(xlabel='turn', ylabel='budget left', xlim=(0, turns + 1), ylim=(0, result.settings.budget * 1.05 or 1))
    return figure


def _scene(result: EpisodeResult, world: PerceivedWorld) -> Figure:
    """Draw the scene in which most was asked, with the objects that were asked about or shown."""
    turns = result.settings.turns
    starts = [1, *world.change_turns(turns)]
    ends = [*(turn - 1 for turn in starts[1:]), turns]
    asked = [
        [record for record in result.queries if start <= record.turn <= end]
        for start, end in zip(starts, ends, strict=True)
    ]
    about = [{record.object_id: record for record in records if record.object_id is not None} for records in asked]
    best = max(range(len(starts)), key=lambda index: len(about[index]))
    marks = {object_id: _mark(record) for object_id, record in about[best].items()}
    picture = draw_scene(world.observations(starts[best]), marks).image
    count = Counter(record.kind for record in asked[best])
    told = (
        ', '.join(
            number_of(count[kind], f'{kind_name(kind)} query', f'{kind_name(kind)} queries')
            for kind in KIND_COLOURS
            if count[kind]
        )
        or 'nothing was asked'
    )
    shown = f'turn {ends[best]}' if starts[best] == ends[best] else f'turns {starts[best]} to {ends[best]}'
    return _framed(picture, f'{_title(result)}\n{shown}: {told}')


def _new_table(result: EpisodeResult, new_table: NewTable) -> Figure:
    """Draw a new table with what its things are taken for; what is rightly taken for none has no mark."""
    marks = {thing.object_id: mark for thing in new_table.recognition.things if (mark := _told(new_table, thing))}
    picture = draw_scene(new_table.table.observations, marks).image
    about = f'{len(new_table.right)} of {len(new_table.recognition.things)} things on a new table are recognised'
    legend = 'green: right, red: wrong, grey: not known, no ring: rightly none'
    return _framed(picture, f'{_title(result)}\n{about} ({legend})')


def _told(new_table: NewTable, thing: RecognisedThing) -> Mark | None:
    if not thing.is_known:
        return Mark(NOT_KNOWN, '?')
    if new_table.is_right(thing):
        return None if thing.best == NO_SYMBOL else Mark(RIGHT, thing.best)
    return Mark(WRONG, thing.best)


def _framed(picture: NDArray[np.uint8], title: str) -> Figure:
    height, width, _ = picture.shape
    figure = new_figure(9, 9 * height / width + 0.5)
    axes = figure.subplots()
    axes.imshow(picture)
    axes.set_axis_off()
    axes.set_title(title, loc='left', fontsize=11)
    return figure


def _mark(record: QueryRecord) -> Mark:
    told = record.symbol if record.symbol and record.outcome is Outcome.ANSWERED else '?'
    red, green, blue = (round(255 * part) for part in to_rgb(KIND_COLOURS[record.kind]))
    return Mark((red, green, blue), told)


def _title(result: EpisodeResult) -> str:
    settings = result.settings
    limits = f'budget {settings.budget:g}, {number_of(settings.turns, "turn")}'
    return f'{result.world_spec.task.name}, {settings.strategy}, {limits}, seed {result.world_spec.seed}'
