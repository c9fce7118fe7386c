"""The tables of experiments, read together."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from al_questioner.domain import InputError
from al_questioner.experiments.results import read_together

EPISODE = {'task': 'prepare_lunch', 'budget': '25', 'turns': '40', 'strategy': 'dt_iros', 'sample': '0'}
FOUND = {'final_accuracy': '.5', 'mean_accuracy': '.4', 'queries': '13', 'spent': '25'}
TURN = {'turn': '1', 'accuracy': '.3', 'kind': 'no_query', 'object_id': '', 'symbol': '', 'outcome': '', 'spent': '0'}


def write(folder: Path, *samples: int) -> Path:
    folder.mkdir()
    for name, columns in (('episodes', FOUND), ('turns', TURN)):
        with (folder / f'{name}.csv').open('w', newline='') as file:
            table = csv.DictWriter(file, [*EPISODE, *columns])
            table.writeheader()
            table.writerows({**EPISODE, 'sample': sample, **columns} for sample in samples)
    return folder


def test_experiments_are_read_as_one(tmp_path: Path) -> None:
    """Strategies that were played one after the other could not be compared."""
    folders = [write(tmp_path / 'a', 0, 1), write(tmp_path / 'b', 2)]
    together = read_together(folders)
    assert together.samples == (0, 1, 2)
    assert len(together.turns) == 3


def test_an_episode_that_is_there_twice_is_named(tmp_path: Path) -> None:
    """A sample would count double, and a difference seem more certain than it is."""
    first, other = write(tmp_path / 'a', 0, 1, 2), write(tmp_path / 'b', 1, 2, 3)
    for folders, sample in (([first, other], 1), ([first, first], 0)):
        with pytest.raises(InputError) as caught:
            read_together(folders)
        twice = f'prepare_lunch, 25/40, dt_iros, sample {sample}'
        assert str(caught.value) == f'{folders[1]}: an episode is there twice: {twice}'
