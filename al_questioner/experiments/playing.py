"""Playing of an experiment's episodes, as a worker process does it."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from al_questioner.experiments.ceilings import CEILING_SETTINGS, CEILINGS
from al_questioner.experiments.plan import Cell, Variation
from al_questioner.simulation import (
    EpisodeResult,
    Evaluation,
    PerceivedWorld,
    ScriptedTeacher,
    SeenWorld,
    WorldSpec,
    episode_settings,
    run_episode,
)

Row = dict[str, Any]

CELL_COLUMNS = ('task', 'budget', 'turns', 'strategy', 'sample', 'seed')
EPISODE_COLUMNS = (*CELL_COLUMNS, 'final_accuracy', 'mean_accuracy', 'queries', 'spent')
TURN_COLUMNS = (*CELL_COLUMNS, 'turn', 'accuracy', 'kind', 'object_id', 'symbol', 'outcome', 'spent')


@dataclass(frozen=True)
class Played:
    """Result of a cell.

    Attributes:
        cell: the cell.
        episode: a row by `EPISODE_COLUMNS`; empty if it failed.
        turns: rows by `TURN_COLUMNS`.
        error: reason of a failure; empty if there was none.
        seconds: its duration, with the opening of its world if it was the first one there.
    """

    cell: Cell
    episode: Row
    turns: tuple[Row, ...]
    error: str = ''
    seconds: float = 0.0


def play_cells(cells: Sequence[Cell], variation: Variation, dataset: str = '') -> Iterator[Played]:
    """Play episodes of one task and sample in one world, one after the other; a failure does not stop the others."""
    for cell in cells:
        began = time.monotonic()
        played = _play(cell, variation, dataset)
        yield dataclasses.replace(played, seconds=time.monotonic() - began)


def _play(cell: Cell, variation: Variation, dataset: str) -> Played:
    try:
        return rows_of(cell, play_episode(cell, variation, dataset))
    except Exception as error:  # noqa: BLE001 - any error is reported, and the experiment goes on
        return Played(cell, {}, (), f'{type(error).__name__}: {error}')


def play_episode(cell: Cell, variation: Variation, dataset: str = '') -> EpisodeResult:
    """Play the episode of a cell."""
    task = variation.task(cell.task).of_sample(cell.sample)
    world_spec = WorldSpec(task, cell.seed, cell.sample, Path(dataset) if dataset else None)
    world = _open_world(cell.task, cell.sample, variation.change_interval, variation.synchrony, dataset)
    return play_in(world_spec, world, cell, variation)


def play_in(world_spec: WorldSpec, world: SeenWorld, cell: Cell, variation: Variation) -> EpisodeResult:
    """Play the episode of a cell in an open world, with the teacher of the variation.

    Raises:
        InputError: a ceiling that needs more than this world has.
    """
    task = world_spec.task
    teacher = ScriptedTeacher(
        task.symbols,
        task.relevant_groups,
        cell.seed,
        variation.wrong_rate,
        variation.unknown_rate,
        repeat_shown=variation.repeat_shown,
        relevance_omission=variation.relevance_omission,
        relevance_false_alarm=variation.relevance_false_alarm,
    )
    varied = {**variation.classifiers._asdict(), 'carry_labels': variation.carry_labels}
    if cell.strategy in CEILINGS:
        settings = episode_settings(task, CEILING_SETTINGS, cell.budget, cell.turns, **varied)
        return CEILINGS[cell.strategy](Evaluation(world_spec, settings, None, world), task, teacher)
    settings = episode_settings(task, cell.strategy, cell.budget, cell.turns, **varied)
    if cell.strategy in variation.weights:
        settings = dataclasses.replace(settings, weights=variation.weights[cell.strategy])
    return run_episode(world_spec, settings, teacher, world=world, strategy=variation.strategy(cell.strategy))


@lru_cache(maxsize=2)
def _open_world(
    task: str, sample: int, change_interval: int | None, synchrony: float | None, dataset: str
) -> PerceivedWorld:
    """Return the world of a sample; it is kept for the next cells, so that its views are drawn and measured once."""
    varied = Variation(change_interval, synchrony).task(task)
    return PerceivedWorld(WorldSpec(varied, sample, sample, Path(dataset) if dataset else None).open())


def rows_of(cell: Cell, result: EpisodeResult) -> Played:
    """Return a played cell as rows of the tables."""
    shared = {**dataclasses.asdict(cell), 'seed': cell.seed}
    episode = {
        **shared,
        'final_accuracy': result.final_accuracy,
        'mean_accuracy': statistics.fmean(result.accuracy),
        'queries': len(result.queries),
        'spent': result.spent,
    }
    by_turn = {record.turn: record for record in result.queries}
    turns, spent = [], 0.0
    for turn, accuracy in enumerate(result.accuracy, 1):
        record = by_turn.get(turn)
        spent += record.cost if record else 0.0
        told: tuple[object, ...] = ('no_query', None, None, None)
        if record is not None:
            told = (record.kind.value, record.object_id, record.symbol, record.outcome.value)
        turns.append(shared | dict(zip(TURN_COLUMNS[6:], (turn, accuracy, *told, spent), strict=True)))
    return Played(cell, episode, tuple(turns))
