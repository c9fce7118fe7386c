"""The tools that every benchmark relies on."""

from __future__ import annotations

import math

import pytest


def test_median_and_spread_ignore_an_outlier() -> None:
    """Otherwise one interrupted call would decide the figure."""
    from measuring import median_and_spread

    assert median_and_spread([1.0, 2.0, 3.0, 4.0, 1000.0]) == (3.0, 2.0)
    assert all(math.isnan(value) for value in median_and_spread([]))


def test_no_cell_is_cut_however_wide(capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a piped table would lose its figures at the eightieth column."""
    from measuring import print_table

    print_table('title', ['name', *(f'a long heading {i}' for i in range(6))], [['x', *['1.5'] * 6], [], ['y'] * 7])
    printed = capsys.readouterr().out
    assert all(f'a long heading {i}' in printed for i in range(6))
    assert '…' not in printed
