"""Readings that no sensor means: the 65535 or 3e38 that stands for 'nothing' among values of 0 to 1."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray
from al_questioner.support.arrays import Array

LARGEST_MEANT = 1e30
"""Size beyond which no sensor means a reading: 3e38, the largest number of 32 bits, is what stands for none."""
LEAST_OTHERS = 3
"""Number of different other readings below which nothing can be said of one that is far away."""
FAR, FAR_AMONG_FEW = 20.0, 20_000.0
"""A reading is implausible if it is farther from the others than FAR + FAR_AMONG_FEW / k^2 times the range of k others.

Few readings say little of the range: of the simulated tables' features, some are 0 for nearly everything. In 48 worlds
of four tasks none comes nearer to the limit than four fifths of it.
"""
OFTEN, MANY = 3, 20
"""Readings of each of a few different values, and of all of them, from which on these are the levels of a feature."""
LARGEST_SHARE = 0.25
"""Share of the readings that can be implausible; what is more frequent is what the feature looks like."""
ALWAYS_EXAMINED = 200
"""Number of readings up to which all features are examined with every view; later, those with a new extreme."""


class PlausibleRange:
    """The range of each feature's plausible readings, from all readings so far.

    What is implausible may show only later, when more is known of the range.

    Args:
        n_features: m.

    Attributes:
        lowest, highest: (m,) the ends of the range; infinite at an end beyond which nothing was read.
    """

    def __init__(self, n_features: int) -> None:
        self.lowest: Array = np.full(n_features, -np.inf)
        self.highest: Array = np.full(n_features, np.inf)
        self._extremes = np.full((2, n_features), np.nan)
        self._farthest = np.tile([[-np.inf], [np.inf]], n_features)
        self._table: NDArray[np.float64] = np.zeros((0, n_features))
        self._count = 0

    @property
    def is_limited(self) -> NDArray[np.bool_]:
        """(m,) whether a feature has implausible readings."""
        return np.asarray(np.isfinite(self.lowest) | np.isfinite(self.highest))

    def add(self, readings: Array) -> None:
        """Take in (n, m) readings."""
        self._append(readings)
        low, high = readings.min(axis=0), readings.max(axis=0)
        is_new = ~((low >= self._extremes[0]) & (high <= self._extremes[1])) | (self._count <= ALWAYS_EXAMINED)
        self._extremes = np.array([np.fmin(self._extremes[0], low), np.fmax(self._extremes[1], high)])
        columns = np.flatnonzero(is_new)
        for column, ordered in zip(columns, np.sort(self._readings[:, columns], axis=0).T, strict=True):
            first, last = _plausible_part(ordered)
            self.lowest[column] = ordered[first] if first else -np.inf
            self.highest[column] = ordered[last - 1] if last < len(ordered) else np.inf
            self._farthest[:, column] = _farthest_plausible(ordered[first:last])

    def plausible(self, column: int) -> Array:
        """The plausible readings of a feature."""
        readings: Array = self._readings[:, column]
        found: Array = readings[(readings >= self.lowest[column]) & (readings <= self.highest[column])]
        return found

    def clip(self, readings: Array) -> Array:
        """(n, m) readings with the implausible ones at the end of their range."""
        return np.clip(readings, self.lowest, self.highest) if self.is_limited.any() else readings

    def are_implausible(self, readings: FloatArray) -> NDArray[np.bool_]:
        """(n, m) which of the readings are too far from the plausible ones, or would be if they were taken in."""
        return np.asarray((readings < self._farthest[0]) | (readings > self._farthest[1]))

    @property
    def _readings(self) -> Array:
        return self._table[: self._count]

    def _append(self, readings: Array) -> None:
        needed = self._count + len(readings)
        if needed > len(self._table):
            larger = np.zeros((max(needed, 2 * len(self._table)), self._table.shape[1]))
            larger[: self._count] = self._readings
            self._table = larger
        self._table[self._count : needed] = readings
        self._count = needed


def _plausible_part(ordered: Array) -> tuple[int, int]:
    """The first of a feature's plausible readings, and the one after the last, given all readings in order."""
    first = int(np.searchsorted(ordered, -LARGEST_MEANT, 'right'))
    last = int(np.searchsorted(ordered, LARGEST_MEANT))
    if first == last:
        first, last = 0, len(ordered)
    most = int(LARGEST_SHARE * (last - first))
    while most:
        below, above = _implausible_at_the_ends(ordered[first:last], most)
        if below == above == 0:
            break
        first, last, most = first + below, last - above, most - below - above
    return first, last


def _farthest_plausible(ordered: Array) -> tuple[float, float]:
    """The lowest and the highest reading that would be plausible beside these, which are in order."""
    limit = _largest_gap(ordered)
    lowest, highest = ordered[0] - limit, ordered[-1] + limit
    if np.abs(ordered[[0, -1]]).max() < LARGEST_MEANT:
        lowest, highest = max(lowest, -LARGEST_MEANT), min(highest, LARGEST_MEANT)
    return lowest, highest


def _implausible_at_the_ends(ordered: Array, most: int) -> tuple[int, int]:
    """Number of readings at the lower and the upper end, at most so many in all, that are too far from the others.

    Beyond the widest gap at each end, both at once first, since each hides how far the other one is; else all of one
    end that is beyond a wide gap, since of several wrong readings each hides the others.
    """
    rises = np.diff(ordered)
    if len(rises) < LEAST_OTHERS or not rises.any():
        return 0, 0
    below, above = 1 + int(np.argmax(rises[:most])), 1 + int(np.argmax(rises[::-1][:most]))
    if below + above <= most and _are_far(ordered, below, above):
        return below, above
    # A gap that is too wide is at least FAR times the range of what is inside of it.
    inside = ordered[most : len(ordered) - most]
    least = FAR * (inside[-1] - inside[0])
    for count in range(most, 0, -1):
        if rises[count - 1] > least and _are_far(ordered, count, 0):
            return count, 0
        if rises[-count] > least and _are_far(ordered, 0, count):
            return 0, count
    return 0, 0


def _are_far(ordered: Array, below: int, above: int) -> bool:
    """Whether so many readings at the lower and the upper end are too far from the others."""
    last = len(ordered) - above
    gaps = []
    if below:
        gaps.append(ordered[below] - ordered[below - 1])
    if above:
        gaps.append(ordered[last] - ordered[last - 1])
    return bool(min(gaps) > _largest_gap(ordered[below:last]))


def _largest_gap(others: Array) -> float:
    """The widest gap between a plausible reading and others, which are in order; infinite if they say nothing."""
    values, counts = np.unique(others, return_counts=True)
    # Of a feature of a few levels, each of them seen often, more is known than how many levels there are.
    are_levels = len(others) >= MANY and counts.min() >= OFTEN
    known = len(others) if are_levels else len(values)
    if known < LEAST_OTHERS:
        return np.inf
    extent = values[-1] - values[0] or max(1.0, abs(values[0]))
    return float((FAR + FAR_AMONG_FEW / known**2) * extent)
