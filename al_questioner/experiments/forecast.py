"""Forecast of the remaining time of an experiment."""

from __future__ import annotations

import time
from collections import defaultdict
from collections.abc import Iterable
from statistics import fmean

from al_questioner.experiments.plan import Cell


class Forecast:
    """Forecast from the durations of similar episodes, and from the number of episodes that run in parallel.

    Similar means of the same task, limits and strategy; if there are none, of the same strategy, or any.
    """

    def __init__(self, cells: Iterable[Cell]) -> None:
        self._left: dict[Cell, int] = defaultdict(int)
        for cell in cells:
            self._left[cell] += 1
        self._took: dict[object, list[float]] = defaultdict(list)
        self._began = time.monotonic()

    def played(self, cell: Cell, seconds: float) -> None:
        """Record that a cell was played, and how many seconds its process needed."""
        self._left[cell] -= 1
        for likeness in _likenesses(cell):
            self._took[likeness].append(seconds)

    def seconds_left(self) -> float | None:
        """Return the remaining seconds of real time; None as long as nothing is known."""
        whole = sum(self._took[None])
        elapsed = time.monotonic() - self._began
        if whole <= 0 or elapsed <= 0:
            return None
        left = sum(count * self._expected(cell) for cell, count in self._left.items())
        return left / (whole / elapsed)

    def _expected(self, cell: Cell) -> float:
        return fmean(next(self._took[likeness] for likeness in _likenesses(cell) if self._took.get(likeness)))


def _likenesses(cell: Cell) -> tuple[object, ...]:
    return (cell.task, cell.condition, cell.strategy), cell.strategy, None
