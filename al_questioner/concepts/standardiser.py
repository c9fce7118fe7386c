"""Standardisation of features to standard deviations from their mean, with statistics of unlabelled observations."""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.plausible_range import PlausibleRange
from al_questioner.domain import FloatArray, InputError
from al_questioner.support.arrays import Array


class Standardiser:
    """Running mean and variance of every feature.

    Before the first observation it changes nothing. A constant feature is centred and not scaled. Implausible
    readings do not count, and are replaced by the end of their feature's range, see `PlausibleRange`.

    Attributes:
        count: number of observations.
        mean: (m,) float64.
        scale: (m,) float64, the standard deviation, 1 for a constant feature.
    """

    def __init__(self, n_features: int) -> None:
        self.count = 0
        self.mean: Array = np.zeros(n_features)
        self._mean_of_all: Array = np.zeros(n_features)
        self._varies = np.zeros(n_features, dtype=bool)
        self.scale: Array = np.ones(n_features)
        self.plausible_range = PlausibleRange(n_features)
        self._squared_deviations: Array = np.zeros(n_features)

    def update(self, features: FloatArray) -> None:
        """Add (n, m) observations, by the pairwise update of Chan, Golub and LeVeque (1983).

        Raises:
            InputError: not m columns.
        """
        batch = self._table(features)
        if len(batch) == 0:
            return
        total = self.count + len(batch)
        batch_mean = batch.mean(axis=0)
        shift = batch_mean - self._mean_of_all
        self._squared_deviations += ((batch - batch_mean) ** 2).sum(axis=0)
        self._squared_deviations += shift**2 * (self.count * len(batch) / total)
        self._mean_of_all = self._mean_of_all + shift * (len(batch) / total)
        self.count = total
        self.plausible_range.add(batch)
        self.mean, deviation = self._mean_of_all.copy(), np.sqrt(self._squared_deviations / total)
        for column in np.flatnonzero(self.plausible_range.is_limited):
            readings = self.plausible_range.plausible(int(column))
            self.mean[column], deviation[column] = readings.mean(), readings.std()
        # Observations are float32: a spread below their resolution is rounding, and must not be scaled up.
        self._varies = deviation > np.finfo(np.float32).eps * np.abs(self.mean)
        self.scale = np.where(self._varies, deviation, 1.0)

    @property
    def spread(self) -> Array:
        """Spread of each feature among objects, (m,); for a constant feature, the size of its values (1 for zero)."""
        size = np.where(self.mean == 0, 1.0, np.abs(self.mean))
        return np.where(self._varies, self.scale, size)

    def transform(self, features: FloatArray) -> Array:
        """Return (n, m) float64 standardised features.

        Raises:
            InputError: not m columns.
        """
        return (self.plausible_range.clip(self._table(features)) - self.mean) / self.scale

    def _table(self, features: FloatArray) -> Array:
        table = np.asarray(features, dtype=np.float64)
        if table.ndim != 2 or table.shape[1] != len(self.mean):
            raise InputError(f'features have shape {table.shape}, expected (n, {len(self.mean)})')
        return table
