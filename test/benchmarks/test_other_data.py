"""The comparison on data that are not ours."""

from __future__ import annotations

import json
from pathlib import Path

import pytest


@pytest.mark.parametrize(
    ('name', 'things', 'symbols', 'groups', 'group'),
    [
        ('digits', 1797, 10, 8, 'row7'),
        ('wine', 178, 3, 13, 'malic-acid'),
        ('cancer', 569, 2, 10, 'concave-points'),
    ],
)
def test_the_groups_are_natural(name: str, things: int, symbols: int, groups: int, group: str) -> None:
    """The teacher can only be asked which groups matter if they mean something."""
    from other_data import DATA

    pool = DATA[name]()
    assert (len(pool), len(pool.symbols), len(pool.groups)) == (things, symbols, groups)
    assert group in pool.groups


def test_it_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise the table would rot unseen."""
    import other_data

    path = tmp_path / 'accuracies.json'
    chosen = ['--strategy', 'value_per_cost', 'random_fsq', '--splits', '2', '--first', '3', '--turns', '12']
    assert other_data.main(['--data', 'wine', *chosen, '--jobs', '1', '--json', str(path)]) == 0
    printed = capsys.readouterr().out
    assert 'wine, 2 samples' in printed
    assert 'Is value_per_cost more accurate?' in printed
    rows = json.loads(path.read_text())
    assert [(row['strategy'], row['split']) for row in rows[:3]] == [
        ('value_per_cost', 3), ('random_fsq', 3), ('value_per_cost', 4),
    ]  # fmt: skip
    assert all(row['final_accuracy'] > 0.5 for row in rows)
