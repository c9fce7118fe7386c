"""Tools that the benchmarks share: summing times up, calibration, and printing tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from rich.console import Console
from rich.table import Table

Seconds = NDArray[np.float64]
Array = NDArray[np.float64]
BINS = 10
"""Bins of a probability."""


def median_and_spread(values: ArrayLike) -> tuple[float, float]:
    """Median, and the width of the middle half (third less first quartile); NaN of nothing."""
    numbers = np.asarray(values, dtype=float)
    if numbers.size == 0:
        return float('nan'), float('nan')
    lower, median, upper = np.percentile(numbers, (25, 50, 75))
    return float(median), float(upper - lower)


def calibration_error(sure: Array, right: NDArray[np.bool_]) -> float:
    """Mean difference of probability and share, of the bins by the things in them."""
    counts, probability, share = reliability(sure, right)
    return float((counts * np.abs(probability - share)).sum() / len(sure))


def reliability(sure: Array, right: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Array, Array]:
    """Number of things, mean probability and share of right names in each bin of the probability that has any."""
    of = np.minimum((sure * BINS).astype(int), BINS - 1)
    counts = np.bincount(of, minlength=BINS)
    filled = counts > 0
    means = [np.bincount(of, values, BINS)[filled] / counts[filled] for values in (sure, right)]
    return counts[filled], means[0], means[1]


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
