"""Features in standard deviations from their mean, from statistics of unlabelled observations."""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.arrays import Array
from al_questioner.domain import FloatArray, InputError


class Standardiser:
    """Running mean and variance of every feature.

    Before the first observation it changes nothing. A feature that never varied is centred and not scaled.

    Attributes:
        count: number of observations.
        mean: (m,) float64.
        scale: (m,) float64, the standard deviation, 1 for a constant feature.
    """

    def __init__(self, n_features: int) -> None:
        self.count = 0
        self.mean: Array = np.zeros(n_features)
        self.scale: Array = np.ones(n_features)
        self._squared_deviations: Array = np.zeros(n_features)

    def update(self, features: FloatArray) -> None:
        """Take in (n, m) observations, by the pairwise update of Chan, Golub and LeVeque (1983).

        Raises:
            InputError: not m columns.
        """
        batch = self._table(features)
        if len(batch) == 0:
            return
        total = self.count + len(batch)
        batch_mean = batch.mean(axis=0)
        shift = batch_mean - self.mean
        self._squared_deviations += ((batch - batch_mean) ** 2).sum(axis=0)
        self._squared_deviations += shift**2 * (self.count * len(batch) / total)
        self.mean = self.mean + shift * (len(batch) / total)
        self.count = total
        deviation = np.sqrt(self._squared_deviations / total)
        # Observations are float32: a spread below their resolution is rounding, and must not be blown up.
        varies = deviation > np.finfo(np.float32).eps * np.abs(self.mean)
        self.scale = np.where(varies, deviation, 1.0)

    def transform(self, features: FloatArray) -> Array:
        """(n, m) float64 standardised features.

        Raises:
            InputError: not m columns.
        """
        return (self._table(features) - self.mean) / self.scale

    def _table(self, features: FloatArray) -> Array:
        table = np.asarray(features, dtype=np.float64)
        if table.ndim != 2 or table.shape[1] != len(self.mean):
            raise InputError(f'features have shape {table.shape}, expected (n, {len(self.mean)})')
        return table
