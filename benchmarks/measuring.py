"""Tools that the benchmarks share: summing times up, and printing tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.console import Console
from rich.table import Table

Seconds = NDArray[np.float64]


def median_and_spread(values: ArrayLike) -> tuple[float, float]:
    """Median, and the width of the middle half (third less first quartile); NaN of nothing."""
    numbers = np.asarray(values, dtype=float)
    if numbers.size == 0:
        return float('nan'), float('nan')
    lower, median, upper = np.percentile(numbers, (25, 50, 75))
    return float(median), float(upper - lower)


def print_table(title: str, columns: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table; all columns but the first are aligned to the right, and an empty row draws a line."""
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
