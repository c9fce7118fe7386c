"""Ranges of plausible sensor readings; outside are values such as 65535 or 3e38 that mean 'no reading'."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray
from al_questioner.support.arrays import Array

LARGEST_MEANT = 1e30
"""Largest size of a real reading; 3e38, the largest 32-bit number, stands for a missing one."""
LEAST_OTHERS = 3
"""Smallest number of different other readings with which a distant reading can be judged."""
FAR, FAR_AMONG_FEW = 20.0, 20_000.0
"""Distance of an implausible reading from k others: more than FAR + FAR_AMONG_FEW / k^2 times the range of these.

Few readings say little about the range: some features of the simulated tables are 0 for nearly every object. In 48
worlds of four tasks no reading exceeds four fifths of the limit.
"""
OFTEN, MANY = 3, 20
"""Smallest number of readings of each value, and of all values, of a feature that has a few fixed levels."""
LARGEST_SHARE = 0.25
"""Largest share of the readings that can be implausible; a more frequent value is normal for the feature."""
ALWAYS_EXAMINED = 200
"""Number of readings up to which all features are examined with every view; later, only those with a new extreme."""


class PlausibleRange:
    """Range of each feature's plausible readings, from all readings so far.

    A reading may become implausible later, when more is known of the range.

    Attributes:
        lowest, highest: (m,) the ends of the range; infinite if no reading lies beyond that end.
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
        """Features that have implausible readings, (m,) booleans."""
        return np.asarray(np.isfinite(self.lowest) | np.isfinite(self.highest))

    def add(self, readings: Array) -> None:
        """Add (n, m) readings."""
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
        """Return the plausible readings of a feature."""
        readings: Array = self._readings[:, column]
        found: Array = readings[(readings >= self.lowest[column]) & (readings <= self.highest[column])]
        return found

    def clip(self, readings: Array) -> Array:
        """Return (n, m) readings in which an implausible one is replaced by the end of its range."""
        return np.clip(readings, self.lowest, self.highest) if self.is_limited.any() else readings

    def are_implausible(self, readings: FloatArray) -> NDArray[np.bool_]:
        """Return (n, m) booleans: the readings that are too far from the plausible ones, or would be once added."""
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
    """Return the start and the end index of a feature's plausible readings, given all readings in order."""
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
    """Return the lowest and the highest reading that would be plausible beside these, which are in order."""
    limit = _largest_gap(ordered)
    lowest, highest = ordered[0] - limit, ordered[-1] + limit
    if np.abs(ordered[[0, -1]]).max() < LARGEST_MEANT:
        lowest, highest = max(lowest, -LARGEST_MEANT), min(highest, LARGEST_MEANT)
    return lowest, highest


def _implausible_at_the_ends(ordered: Array, most: int) -> tuple[int, int]:
    """Return the number of readings at the lower and the upper end that are too far from the others.

    The sum of the two numbers is at most `most`. First both ends are tried, each beyond its widest gap, since one end
    hides how far the other one is. Then all readings of one end beyond a wide gap are tried, since several wrong
    readings hide each other.
    """
    rises = np.diff(ordered)
    if len(rises) < LEAST_OTHERS or not rises.any():
        return 0, 0
    below, above = 1 + int(np.argmax(rises[:most])), 1 + int(np.argmax(rises[::-1][:most]))
    if below + above <= most and _are_far(ordered, below, above):
        return below, above
    # A gap that is too wide is at least FAR times the range of the readings inside of it.
    inside = ordered[most : len(ordered) - most]
    least = FAR * (inside[-1] - inside[0])
    for count in range(most, 0, -1):
        if rises[count - 1] > least and _are_far(ordered, count, 0):
            return count, 0
        if rises[-count] > least and _are_far(ordered, 0, count):
            return 0, count
    return 0, 0


def _are_far(ordered: Array, below: int, above: int) -> bool:
    """Return whether these numbers of readings at the lower and the upper end are too far from the others."""
    last = len(ordered) - above
    gaps = [ordered[at] - ordered[at - 1] for at, count in ((below, below), (last, above)) if count]
    return bool(min(gaps) > _largest_gap(ordered[below:last]))


def _largest_gap(others: Array) -> float:
    """Return the widest gap between a plausible reading and others, given in order; infinite if they are too few."""
    values, counts = np.unique(others, return_counts=True)
    # If a feature has a few levels and each was seen often, every reading counts, not only the number of levels.
    are_levels = len(others) >= MANY and counts.min() >= OFTEN
    known = len(others) if are_levels else len(values)
    if known < LEAST_OTHERS:
        return np.inf
    extent = values[-1] - values[0] or max(1.0, abs(values[0]))
    return float((FAR + FAR_AMONG_FEW / known**2) * extent)
