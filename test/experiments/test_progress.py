"""Progress of an experiment while it runs."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from al_questioner.experiments.plan import Cell
from al_questioner.experiments.playing import Played
from al_questioner.experiments.progress import ExperimentProgress


@pytest.mark.parametrize(('before', 'to_play', 'lines'), [(0, 200, 9), (500, 25, 9), (3, 2, 1), (4, 0, 0)])
def test_a_plain_line_now_and_then(before: int, to_play: int, lines: int) -> None:
    """Otherwise a log would stay empty for hours, or fill with a line for each episode."""
    file = io.StringIO()
    cells = [Cell('prepare_lunch', 3, 4, 'random_fsq', sample) for sample in range(to_play)]
    with ExperimentProgress(Console(file=file), before + to_play) as progress:
        progress.begin(cells)
        for cell in cells:
            progress.watch(Played(cell, {}, (), seconds=1.0))
    assert progress.before == before
    printed = file.getvalue().splitlines()
    assert len(printed) == lines
    assert all(f' of {before + to_play} episodes, about ' in line for line in printed)
