"""Noise of the sensors: the difference between looks at an object while nothing moves."""

from __future__ import annotations

import numpy as np

from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

chdtri, ndtri = late('scipy.special', 'chdtri'), late('scipy.special', 'ndtri')

LOOKS_KEPT = 256
"""Number of latest pairs of looks that the estimate uses; so it follows a noise that changes."""
PRIOR_LOOKS, PRIOR_ENDS = 8, 64
"""Weight of the usual noise in one feature's estimate, and number of pairs from which it is 0; in pairs of looks."""
SMALLEST_NOISE = 0.005
"""Smallest noise, in spreads of a feature; a smaller change says nothing about an object."""
FALSE_ALARM = 1e-6
"""Probability with which noise alone is taken for a change."""
LARGEST_NORM = 3.0
"""Largest length of a look in the estimate of correlations, in medians; so one burst does not decide."""
SHARE_DROPPED, LEAST_DROPPED = 0.1, 2
"""Share and smallest number of the largest differences that the estimate leaves out, because they may be changes."""
WORST_LOOK, WORST_MARGIN = 0.9, 1.5
"""Quantile of the differences of looks at still objects, and the multiple of it up to which a look is no change."""


class ViewNoise:
    """Standard deviation of each feature's noise, and a test whether it explains the difference of two looks.

    Between two looks at the same object every feature differs by sqrt(2) times its noise, unless the object has
    changed. The mean square of such differences, without the largest ones, is robust against the few that are changes.

    Attributes:
        count: number of pairs of looks so far.
    """

    def __init__(self, n_features: int) -> None:
        self.count = 0
        self._pairs: Array = np.zeros((LOOKS_KEPT, n_features))
        self._spread: Array = np.ones(n_features)
        self._deviations: Array = np.zeros(n_features)
        self._limit = 1.0
        self._is_estimated = False

    def learn(self, differences: Array, spread: Array) -> None:
        """Add looks; the noise is estimated at the first access to it.

        Args:
            differences: (k, m) between two looks at each of k objects that seem not to have changed.
            spread: (m,) of each feature among objects. No noise is smaller than `SMALLEST_NOISE` of it. As long as
                there are few looks, the estimate for a feature is drawn towards the usual one, relative to the spread.
        """
        latest = differences[-LOOKS_KEPT:]
        self._pairs[(self.count + np.arange(len(latest))) % LOOKS_KEPT] = latest
        self.count += len(latest)
        self._spread = spread
        self._is_estimated = False

    @property
    def deviations(self) -> Array:
        """Standard deviation of the noise of each feature, (m,) in its unit."""
        if not self._is_estimated:
            self._estimate()
        return self._deviations

    def scale(self, differences: Array) -> Array:
        """Return (k, m) differences between two looks in standard deviations of such a difference."""
        return np.asarray(differences / (np.sqrt(2.0) * self.deviations))

    def excess(self, differences: Array) -> Array:
        """Return (k,) excess of (k, m) differences between two looks; above 1, noise does not explain them.

        It is the mean square of the differences in standard deviations, over the value that noise alone exceeds with
        probability `FALSE_ALARM`. If the noise of the features is correlated, the sum is treated as a chi-squared
        number of fewer degrees of freedom (Satterthwaite 1946). For noise with bursts, the limit follows the observed
        looks.
        """
        scaled = self.scale(differences)
        return np.asarray(np.mean(scaled**2, axis=1) / self._limit)

    def _estimate(self) -> None:
        pairs = self._pairs[: self.count]
        n, m = pairs.shape
        found = _trimmed_deviations(pairs) / np.sqrt(2.0) / self._spread
        usual = np.sort(found)[(m - 1) // 2]
        prior = PRIOR_LOOKS * max(0.0, 1 - n / PRIOR_ENDS)
        mixed = np.sqrt((n * found**2 + prior * usual**2) / (n + prior))
        self._deviations = np.maximum(mixed, SMALLEST_NOISE) * self._spread
        self._is_estimated = True
        scaled = self.scale(pairs)
        freedom = _degrees_of_freedom(scaled)
        worst = np.quantile(np.mean(scaled**2, axis=1), WORST_LOOK) if n else 0.0
        self._limit = max(chdtri(freedom, FALSE_ALARM) / freedom, WORST_MARGIN * worst)


def _trimmed_deviations(pairs: Array) -> Array:
    """Return (m,) standard deviation of each column of (n, m) differences around 0, without the largest ones.

    The rest is taken as normally distributed.
    """
    n, m = pairs.shape
    if n == 0:
        return np.zeros(m)
    kept = n - min(n - 1, max(LEAST_DROPPED, round(SHARE_DROPPED * n)))
    quantile = ndtri((1 + kept / n) / 2)
    # The mean square of a standard normal number that is known to lie within its quantiles.
    expected = 1.0
    if kept < n:
        expected = 1 - 2 * quantile * np.exp(-(quantile**2) / 2) / (np.sqrt(2 * np.pi) * kept / n)
    squares = np.sort(pairs**2, axis=0)[:kept]
    return np.asarray(np.sqrt(squares.mean(axis=0) / expected))


def _degrees_of_freedom(looks: Array) -> float:
    """Return the degrees of freedom of the squared length of a row: trace(C)^2 / trace(C^2) of the rows' covariance C.

    It is estimated from all pairs of rows of (n, m) differences in standard deviations, and lies between 1, where all
    features move together, and m, where they are independent.
    """
    n, m = looks.shape
    norms = np.linalg.norm(looks, axis=1)
    moving = norms > 0
    if moving.sum() < 2:
        return float(m)
    looks, norms = looks[moving], norms[moving]
    cut = looks * np.minimum(1.0, LARGEST_NORM * np.median(norms) / norms)[:, None]
    products = cut @ cut.T
    of_itself = np.diagonal(products)
    n = len(cut)
    mean_square = (np.sum(products**2) - np.sum(of_itself**2)) / (n * (n - 1))
    if mean_square <= 0:
        return float(m)
    return float(np.clip(np.mean(of_itself) ** 2 / mean_square, 1.0, m))
