"""The comparison on data that are not ours."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
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


def test_a_strategy_stands_beside_the_best_control() -> None:
    """The best control has the largest mean, and the errors are those of the paired differences."""
    from other_data import rows_of

    accuracies = {
        'value_per_cost': np.array([0.8, 0.9]),
        'random_fsq': np.array([0.5, 0.74]),
        'farthest_fsq': np.array([0.6, 0.8]),
    }
    assert rows_of(accuracies) == [
        ['value_per_cost', '0.850 ± 0.050', '+0.150 ± 0.050', '0.2500'],
        ['random_fsq', '0.620 ± 0.120', '-0.080 ± 0.020', '1.0000'],
        ['farthest_fsq', '0.700 ± 0.100', '', ''],
    ]
    assert rows_of({'value_per_cost': np.array([0.6])}) == [['value_per_cost', '0.600 ± 0.000', '', '']]


def test_it_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise the table would rot unseen."""
    import other_data

    path = tmp_path / 'accuracies.json'
    chosen = ['--strategy', 'value_per_cost', 'random_fsq', '--splits', '2', '--first', '3', '--turns', '12']
    assert other_data.main(['--data', 'wine', *chosen, '--jobs', '1', '--json', str(path)]) == 0
    printed = capsys.readouterr().out
    assert 'wine, budget 25, 12 turns, splits 3 to 4' in printed
    rows = json.loads(path.read_text())
    assert [(row['strategy'], row['split']) for row in rows[:3]] == [
        ('value_per_cost', 3), ('random_fsq', 3), ('value_per_cost', 4),
    ]  # fmt: skip
    assert all(row['final_accuracy'] > 0.5 for row in rows)
