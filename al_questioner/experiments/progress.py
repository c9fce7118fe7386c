"""Progress of an experiment: a bar in a terminal, otherwise a line at intervals."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import timedelta

from rich import progress as bars
from rich.console import Console

from al_questioner.experiments.forecast import Forecast
from al_questioner.experiments.plan import Cell
from al_questioner.experiments.playing import Played

PARTS = 10
"""Number of parts of an experiment; outside a terminal, a line reports the end of each."""


class ExperimentProgress:
    """Context manager that shows the progress; it must be told of the cells to play and of each played cell.

    Args:
        console: where to show it.
        total: number of cells, including those that were played before.

    Attributes:
        before: number of cells that were played before; None as long as that is not known.
    """

    def __init__(self, console: Console, total: int) -> None:
        self.before: int | None = None
        self._console = console
        self._total = total
        self._played = 0
        self._forecast = Forecast(())
        self._bar = bars.Progress(
            bars.TextColumn('{task.completed:.0f} of {task.total:.0f} episodes'),
            bars.BarColumn(),
            bars.TextColumn('{task.description}'),
            bars.TimeElapsedColumn(),
            bars.TextColumn('{task.fields[left]}'),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )
        self._task = self._bar.add_task('checking the stored episodes', total=total, left='')

    def __enter__(self) -> ExperimentProgress:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        # Before rich 14 a bar ends with an empty line, even if it is disabled.
        if not self._bar.disable:
            self._bar.stop()

    def begin(self, cells: Sequence[Cell]) -> None:
        """Receive the cells to play."""
        self.before = self._total - len(cells)
        self._forecast = Forecast(cells)
        self._bar.update(self._task, completed=self.before, description='playing')

    def watch(self, played: Played) -> None:
        """Receive a cell that was played."""
        self._played += 1
        self._forecast.played(played.cell, played.seconds)
        seconds = self._forecast.seconds_left()
        left = '' if seconds is None else f'about {timedelta(seconds=round(seconds))} left'
        description = f'{played.cell.task} {played.cell.strategy}'
        self._bar.update(self._task, advance=1, description=description, left=left)
        if not self._console.is_terminal and self._ends_a_part():
            done = f'{self._total - self._left} of {self._total} episodes'
            self._console.print(', '.join(filter(None, (done, left))), highlight=False, soft_wrap=True)

    @property
    def _left(self) -> int:
        return self._total - (self.before or 0) - self._played

    def _ends_a_part(self) -> bool:
        to_play = self._played + self._left
        return self._left > 0 and self._played * PARTS // to_play > (self._played - 1) * PARTS // to_play
