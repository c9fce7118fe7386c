"""What the benchmarks share: timing calls, summing them up, and printing tables."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.console import Console
from rich.table import Table

Seconds = NDArray[np.float64]


def time_calls(function: Callable[[], Any], repeats: int) -> Seconds:
    """(repeats,) seconds that each call of a function took, after one that does not count."""
    function()
    result = np.empty(repeats)
    for i in range(repeats):
        start = time.perf_counter()
        function()
        result[i] = time.perf_counter() - start
    return result


def median_and_spread(values: ArrayLike) -> tuple[float, float]:
    """Median, and the width of the middle half (third less first quartile); NaN of nothing."""
    numbers = np.asarray(values, dtype=float)
    if numbers.size == 0:
        return float('nan'), float('nan')
    lower, median, upper = np.percentile(numbers, (25, 50, 75))
    return float(median), float(upper - lower)


def print_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table whose first column is text and whose others are numbers, or text to the right.

    Args:
        title: above the table.
        columns: their headings.
        rows: cells; a row that is empty draws a line.
    """
    table = Table(title=title, title_justify='left', title_style='bold')
    for i, column in enumerate(columns):
        table.add_column(column, justify='right' if i else 'left', no_wrap=True)
    for row in rows:
        if row:
            table.add_row(*row)
        else:
            table.add_section()
    # Through a pipe rich would take 80 columns for the width, and cut what is wider.
    Console(width=200, highlight=False).print(table)
