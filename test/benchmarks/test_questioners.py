"""The tables of a questioner beside the others."""

from __future__ import annotations

import csv
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., tuple[int, str, str]]
EPISODE = ('task', 'budget', 'turns', 'strategy', 'sample')


def write(folder: Path, *strategies: str) -> Path:
    """The tables of an experiment of two samples, in which strategies are the better the further back they stand."""
    folder.mkdir()
    with (folder / 'episodes.csv').open('w', newline='') as file:
        table = csv.writer(file)
        table.writerow([*EPISODE, 'final_accuracy', 'mean_accuracy', 'queries', 'spent'])
        for number, strategy in enumerate(strategies):
            for sample in (0, 1):
                accuracy = 0.5 + (number + sample) / 10
                table.writerow(['kitchen_table', 25, 40, strategy, sample, accuracy, 0.4, 13, 25])
    turn = ('turn', 'accuracy', 'kind', 'object_id', 'symbol', 'outcome', 'spent')
    (folder / 'turns.csv').write_text(','.join((*EPISODE, *turn)))
    return folder


@pytest.fixture
def run(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    """Runs the script; its status, and what it printed."""
    import questioners

    def run_script(*folders: Path | str) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, 'argv', ['questioners.py', *map(str, folders)])
        status: int = questioners.main()
        return status, *capsys.readouterr()

    return run_script


def test_a_questioner_is_compared_with_the_best_control(tmp_path: Path, run: Run) -> None:
    """Accuracies of .7 and .8 by hand, against .6 and .7 of the better one of two controls."""
    status, printed, _ = run(write(tmp_path / 'a', 'random_fsq', 'rarest_demo', 'value_per_cost'))
    lines = printed.splitlines()
    assert status == 0
    assert '| `value_per_cost` | 0.750 ± 0.071 (0.400) |' in lines
    row = lines[lines.index('## value_per_cost against the best control of each cell') + 4]
    assert row.startswith('| kitchen_table | C1 | `rarest_demo` | 2 | 0.750 | 0.650 | +0.100 ± 0.000 |')
    assert '| kitchen_table | `random_fsq` | 2 | 0.750 | 0.550 |' in printed


def test_experiments_are_read_as_one(tmp_path: Path, run: Run) -> None:
    """Otherwise strategies that were played one after the other could not be compared."""
    names = ('random_fsq', 'rarest_demo', 'value_per_cost')
    status, printed, _ = run(*(write(tmp_path / name, name) for name in names))
    assert status == 0
    assert all(f'| `{name}` | 0.550' in printed for name in names)


def test_a_variant_is_compared_with_the_strategy(tmp_path: Path, run: Run) -> None:
    """The same strategy without a question shows what the question is worth."""
    strategies = write(tmp_path / 'a', 'random_fsq', 'value_per_cost')
    page = tmp_path / 'page.md'
    variant = f'never={write(tmp_path / "b", "value_per_cost")}'
    status, printed, _ = run(strategies, variant, '--page', page)
    lines = printed.splitlines()
    assert status == 0
    assert '| `value_per_cost, never` | 0.550 ± 0.071 (0.400) |' in lines
    row = lines[lines.index('## value_per_cost against value_per_cost, never') + 4]
    assert row.startswith('| kitchen_table | C1 | `value_per_cost, never` | 2 | 0.650 | 0.550 | +0.100 ± 0.000 |')
    assert page.read_text().startswith('# ')
    assert printed in page.read_text()


def test_what_cannot_be_compared_is_one_line_and_status_2(tmp_path: Path, run: Run) -> None:
    """A traceback does not say which experiment is missing."""
    alone, controls = write(tmp_path / 'a', 'value_per_cost'), write(tmp_path / 'b', 'random_fsq')
    for folders, reason in (
        ([alone], 'kitchen_table, 25/40: no control was played'),
        ([controls], 'value_per_cost was not played; played were random_fsq'),
        (
            [alone, controls, alone],
            f'{alone}: an episode is there twice: kitchen_table, 25/40, value_per_cost, sample 0',
        ),
        ([tmp_path], 'episodes.csv: cannot be read'),
    ):
        status, printed, error = run(*folders)
        assert (status, printed, error.count('\n')) == (2, '', 1)
        assert reason in error


def test_a_variant_of_fewer_samples_takes_none_from_the_others(tmp_path: Path, run: Run) -> None:
    """Otherwise the main table would be of ten samples because something beside it is."""
    strategies = write(tmp_path / 'a', 'random_fsq', 'value_per_cost')
    variant = write(tmp_path / 'b', 'value_per_cost')
    table = variant / 'episodes.csv'
    table.write_text(''.join(table.read_text().splitlines(keepends=True)[:2]))
    status, printed, _ = run(strategies, f'few={variant}')
    assert status == 0
    assert '## kitchen_table, 2 samples' in printed
    assert '## kitchen_table, few, 1 samples' in printed
