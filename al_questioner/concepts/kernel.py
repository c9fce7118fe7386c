"""Covariances of views: the RBF kernel, and one in which groups of features count alike and single features saturate.

With w_j the share of feature j, sum 1, and c the saturation,

    kappa(x, x') = sum_j w_j exp(-(x_j - x'_j)^2 / 2c^2)
    k(x, x') = amplitude * exp((c^2 / l^2) (kappa(x, x') - 1)).

Sums, products and exponentials of covariances are covariances, so k is one, and k(x, x) is the amplitude. With c to
infinity and equal shares it is the RBF kernel of length scale l sqrt(m). Derived in docs/explanation/method.md.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.domain import FloatArray, InputError
from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

cdist = late('scipy.spatial.distance', 'cdist')

CHUNK_NUMBERS = 500_000
"""Largest table of differences of single features, in numbers."""


@dataclass(frozen=True)
class Kernel:
    """Size and reach of a covariance: of the RBF kernel, amplitude * exp(-d^2 / (2 length_scale^2)).

    Attributes:
        amplitude: variance of the process.
        length_scale: length scale, in the unit of the points.
    """

    amplitude: float
    length_scale: float


@dataclass(frozen=True)
class KernelShape:
    """Treatment of groups of features and of large differences by a kernel.

    Attributes:
        saturation: difference of a feature, in standard deviations, at which it begins to saturate; infinity: never.
        group_exponent: each feature of a group of m counts as m to minus this: 0 counts all features alike, 1 all
            groups.

    Raises:
        InputError: a saturation that is not above 0, or an exponent outside [0, 1].
    """

    saturation: float = np.inf
    group_exponent: float = 0.0

    def __post_init__(self) -> None:
        if not self.saturation > 0:
            raise InputError(f'the saturation must be a number above 0, not {self.saturation}')
        if not 0 <= self.group_exponent <= 1:
            raise InputError(f'the group exponent must lie in [0, 1], not {self.group_exponent}')

    def shares(self, groups: Sequence[str]) -> Array:
        """Return the (m,) shares w of the features whose groups these are."""
        sizes = Counter(groups)
        weights = np.array([sizes[group] ** -self.group_exponent for group in groups])
        return np.asarray(weights / weights.sum())


RBF = KernelShape()
GROUPED = KernelShape(saturation=2.0, group_exponent=0.5)
KERNEL_SHAPES = {'grouped': GROUPED, 'rbf': RBF}
"""Kernel shapes by the names that settings give them."""


def rbf_kernel(first: FloatArray, second: FloatArray, amplitude: float, length_scale: float) -> Array:
    """Return the covariance amplitude * exp(-d^2 / (2 length_scale^2)) of every pair of rows.

    Args:
        first: (n, m) points.
        second: (k, m) points.
        amplitude: variance of the process.
        length_scale: length scale, in the unit of the points.

    Returns:
        (n, k) covariances.
    """
    # Differences, not |a|^2 + |b|^2 - 2ab: by its rounding, duplicated points would have a distance.
    squared = cdist(first, second, 'sqeuclidean')
    covariance: Array = amplitude * np.exp(squared * (-0.5 / length_scale**2))
    return covariance


def saturating_kernel(
    first: FloatArray, second: FloatArray, amplitude: float, length_scale: float, shares: Array, saturation: float
) -> Array:
    """Return the covariance k of every pair of rows, as above.

    Args:
        first: (n, m) points.
        second: (k, m) points.
        amplitude: variance of the process.
        length_scale: l, in the unit of the points, of a difference that is alike in all features.
        shares: (m,) shares w of the features.
        saturation: c, in the unit of the points; infinity for none.

    Returns:
        (n, k) covariances.
    """
    if np.isinf(saturation):
        root = np.sqrt(shares)
        return rbf_kernel(first * root, second * root, amplitude, length_scale)
    covariance = np.empty((len(first), len(second)))
    rows = max(1, CHUNK_NUMBERS // max(1, second.size))
    for start in range(0, len(first), rows):
        difference = first[start : start + rows, None] - second
        np.square(difference, out=difference)
        difference *= -0.5 / saturation**2
        # Of equal points this is 0 exactly, whatever the shares add up to.
        np.expm1(difference, out=difference)
        covariance[start : start + rows] = np.matmul(difference, shares)
    covariance *= (saturation / length_scale) ** 2
    np.exp(covariance, out=covariance)
    covariance *= amplitude
    return covariance
