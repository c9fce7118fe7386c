"""Quadratic forms of resolvents by Lanczos' method, between bounds that hold.

For a symmetric matrix S > -I with all eigenvalues in [lower, upper] and a vector v, the form v' (I + S)^-1 v is |v|^2
times the continued fraction 1 / (1 + a_1 - b_1 / (1 + a_2 - b_2 / ...)) of the coefficients that Lanczos' method finds.
After K steps the rest of the fraction, 1 / (1 + a_K - ...), is the mean of 1 / (1 + s) over a distribution of mean a_K
on [lower, upper]: at least its value at the mean, at most that of the chord. Golub and Meurant, Matrices, Moments and
Quadrature (1993).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.gaussian_process import Array

Single = NDArray[np.float32]

LEAST_STEPS = 2
MOST_STEPS = 6
"""Single precision keeps Lanczos' vectors orthogonal for about so many steps."""

ROUNDING = 1e-6
"""Relative error of a form in single precision, of vectors of a few hundred numbers."""


def resolvent_forms(
    start: Single,
    change: Single,
    spread: Callable[[Single, NDArray[np.intp]], Single],
    lower: Array,
    upper: Array,
    tolerance: float,
) -> tuple[Array, Array]:
    """Forms v' (I + S)^-1 v with S = T^1/2 E T^1/2 and v = T^1/2 u, for many E and u at once.

    A row that is within its tolerance after `LEAST_STEPS` takes no part in the further ones.

    Args:
        start: (R, n) u.
        change: (R, n) diagonals of E.
        spread: from (Q, n) vectors and (Q,) the rows they stand for, ascending, to T times each.
        lower: (R,) a bound of the eigenvalues of S from below, in (-1, 0].
        upper: (R,) a bound from above, 0 or more.
        tolerance: error at which a row is done.

    Returns:
        (R,) the forms and (R,) bounds on their errors; a bound is not finite where single precision overflows.
    """
    rows: NDArray[np.intp] = np.arange(len(start))
    value, error = np.zeros(len(start)), np.full(len(start), np.inf)
    vector, previous = start, np.zeros_like(start)
    total = norm = np.zeros(len(start))
    means: list[Array] = []
    couplings: list[Array] = []
    for step in range(1, MOST_STEPS + 1):
        image = spread(vector, rows)
        squared = np.maximum(_dot(vector, image), 0)
        if step == 1:
            total = squared
        else:
            couplings.append(_ratio(squared, norm))
        norm = squared
        following = change * image
        means.append(_ratio(_dot(image, following), norm))
        low, high = _bounds(means, couplings, lower, upper)
        value[rows] = total * low
        error[rows] = total * (high - low + ROUNDING * high**2)
        if step >= LEAST_STEPS:
            left = np.flatnonzero(~(error[rows] <= tolerance))
            if len(left) == 0:
                break
            rows, total, norm = rows[left], total[left], norm[left]
            lower, upper, change = lower[left], upper[left], change[left]
            following, vector, previous = following[left], vector[left], previous[left]
            means, couplings = [mean[left] for mean in means], [coupling[left] for coupling in couplings]
        following -= means[-1].astype(np.float32)[:, None] * vector
        if couplings:
            following -= couplings[-1].astype(np.float32)[:, None] * previous
        vector, previous = following, vector
    return value, error


def _bounds(means: list[Array], couplings: list[Array], lower: Array, upper: Array) -> tuple[Array, Array]:
    """The continued fraction with the least and with the largest that its rest can be."""
    last = np.clip(means[-1], lower, upper)
    low, high = 1 / (1 + last), (1 + lower + upper - last) / ((1 + lower) * (1 + upper))
    for mean, coupling in zip(means[-2::-1], couplings[::-1], strict=True):
        low, high = 1 / (1 + mean - coupling * low), 1 / (1 + mean - coupling * high)
    return low, high


def _dot(first: Single, second: Single) -> Array:
    product: Array = np.einsum('rn,rn->r', first, second).astype(np.float64)
    return product


def _ratio(numerator: Array, denominator: Array) -> Array:
    """Their ratio; 0 where the denominator is 0, which ends the fraction there."""
    return numerator / np.where(denominator > 0, denominator, 1.0) * (denominator > 0)
