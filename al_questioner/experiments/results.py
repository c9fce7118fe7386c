"""Results of an experiment, read from its tables."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from al_questioner.domain import InputError
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.experiments.plan import (
    CONTROLS,
    PAPER_CONDITIONS,
    PAPER_STRATEGIES,
    PAPER_TASKS,
    PROPOSED,
    Cell,
    Condition,
)
from al_questioner.support.arrays import Array
from al_questioner.support.text import number_of


@dataclass(frozen=True, eq=False)
class EpisodeRow:
    """A row of `episodes.csv`."""

    cell: Cell
    final_accuracy: float
    mean_accuracy: float
    queries: int
    spent: float


@dataclass(frozen=True, eq=False)
class TurnRow:
    """A row of `turns.csv`; `kind` is 'no_query' for a turn without a query."""

    cell: Cell
    turn: int
    accuracy: float
    kind: str
    object_id: str
    symbol: str
    outcome: str
    spent: float


@dataclass(frozen=True, eq=False)
class Results:
    """The tables of an experiment.

    Attributes:
        episodes: rows of `episodes.csv`.
        turns: rows of `turns.csv`.
        numbered: whether conditions of the paper bear its numbers, C1 to C4.
    """

    episodes: Sequence[EpisodeRow]
    turns: Sequence[TurnRow]
    numbered: bool = True

    def of_samples(self, samples: Collection[int]) -> Results:
        """Return the results of these samples."""
        return dataclasses.replace(
            self,
            episodes=[row for row in self.episodes if row.cell.sample in samples],
            turns=[row for row in self.turns if row.cell.sample in samples],
        )

    @cached_property
    def samples(self) -> tuple[int, ...]:
        """Numbers of the samples."""
        return tuple(sorted({row.cell.sample for row in self.episodes}))

    @cached_property
    def tasks(self) -> tuple[str, ...]:
        """Tasks, those of the paper first."""
        found = dict.fromkeys(row.cell.task for row in self.episodes)
        return (*(name for name in PAPER_TASKS if name in found), *(name for name in found if name not in PAPER_TASKS))

    @cached_property
    def strategies(self) -> tuple[str, ...]:
        """Strategies: those of the paper first, then ours, the controls, then the ceilings, then others."""
        known = (*PAPER_STRATEGIES, *PROPOSED, *CONTROLS, *CEILINGS)
        found = dict.fromkeys(row.cell.strategy for row in self.episodes)
        return (*(name for name in known if name in found), *(name for name in found if name not in known))

    def conditions(self, task: str) -> tuple[Condition, ...]:
        """Return the conditions of a task."""
        return tuple(dict.fromkeys(row.cell.condition for row in self.episodes if row.cell.task == task))

    def name_of(self, condition: Condition) -> str:
        """Return a condition in words, with the paper's number if it has one."""
        numbers = {value: name for name, value in PAPER_CONDITIONS.items()} if self.numbered else {}
        limits = f'budget {condition.budget:g}, {number_of(condition.turns, "turn")}'
        return f'{numbers[condition]}: {limits}' if condition in numbers else limits

    @cached_property
    def _by_group(self) -> Mapping[tuple[str, Condition, str], list[EpisodeRow]]:
        groups: dict[tuple[str, Condition, str], list[EpisodeRow]] = {}
        for row in self.episodes:
            groups.setdefault((row.cell.task, row.cell.condition, row.cell.strategy), []).append(row)
        return {key: sorted(rows, key=lambda row: row.cell.sample) for key, rows in groups.items()}

    @cached_property
    def _turns_by_cell(self) -> Mapping[Cell, list[TurnRow]]:
        cells: dict[Cell, list[TurnRow]] = {}
        for row in self.turns:
            cells.setdefault(row.cell, []).append(row)
        return {cell: sorted(rows, key=lambda row: row.turn) for cell, rows in cells.items()}

    def group(self, task: str, condition: Condition, strategy: str) -> list[EpisodeRow]:
        """Return the episodes of a task, a condition and a strategy, by sample."""
        return self._by_group.get((task, condition, strategy), [])

    def mean_accuracy(self, task: str, condition: Condition, strategy: str) -> float | None:
        """Return the accuracy at the end of the time, mean over the samples; None without any."""
        values = [row.final_accuracy for row in self.group(task, condition, strategy)]
        return float(np.mean(values)) if values else None

    def final_accuracies(self, task: str, condition: Condition) -> dict[str, Array]:
        """Return (n,) accuracies at the end of the time by strategy, of the samples that all strategies have.

        A ceiling, which may have been played on fewer samples, takes none from the others.
        """
        groups = {name: self.group(task, condition, name) for name in self.strategies}
        groups = {name: rows for name, rows in groups.items() if rows}
        compared = [rows for name, rows in groups.items() if name not in CEILINGS] or list(groups.values())
        shared = set.intersection(*({row.cell.sample for row in rows} for rows in compared)) if groups else set()
        return {
            name: np.array([row.final_accuracy for row in rows if row.cell.sample in shared])
            for name, rows in groups.items()
        }

    def turns_of(self, cell: Cell) -> list[TurnRow]:
        """Return the turns of an episode, in order."""
        return self._turns_by_cell.get(cell, [])

    def curves(self, task: str, condition: Condition, strategy: str) -> Array:
        """Return (n, T) accuracy after each turn, by sample."""
        rows = [self.turns_of(row.cell) for row in self.group(task, condition, strategy)]
        return np.array([[turn.accuracy for turn in episode] for episode in rows])


def results_of(episodes: Iterable[Mapping[str, Any]], turns: Iterable[Mapping[str, Any]]) -> Results:
    """Return the results in rows of the two tables, whose members are values or, as in a file, their texts.

    Raises:
        InputError: a row that is not one of an experiment.
    """
    return Results(
        [
            EpisodeRow(
                _cell(row),
                float(row['final_accuracy']),
                float(row['mean_accuracy']),
                int(row['queries']),
                float(row['spent']),
            )
            for row in episodes
        ],
        [
            TurnRow(
                _cell(row),
                int(row['turn']),
                float(row['accuracy']),
                row['kind'],
                _text(row['object_id']),
                _text(row['symbol']),
                _text(row['outcome']),
                float(row['spent']),
            )
            for row in turns
        ],
    )


def read_results(folder: Path) -> Results:
    """Read `episodes.csv` and `turns.csv` of an experiment.

    Raises:
        InputError: a table is missing or is not one of an experiment.
    """
    results = results_of(_rows(folder / 'episodes.csv'), _rows(folder / 'turns.csv'))
    if not results.episodes:
        raise InputError(f'{folder}: no episode has been played yet')
    return results


def _rows(path: Path) -> list[dict[str, str]]:
    try:
        with path.open(newline='', encoding='utf-8') as file:
            return list(csv.DictReader(file))
    except (OSError, ValueError) as error:
        raise InputError(f'{path}: cannot be read ({error})') from error


def _text(value: object) -> str:
    """Return a value as a table has it: what is missing is empty."""
    return '' if value is None else str(value)


def _cell(row: Mapping[str, Any]) -> Cell:
    try:
        return Cell(row['task'], float(row['budget']), int(row['turns']), row['strategy'], int(row['sample']))
    except (KeyError, ValueError) as error:
        raise InputError(f'a row of the tables is not one of an experiment ({error})') from error
