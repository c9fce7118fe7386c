"""Quadratic forms of resolvents by Lanczos' method, with guaranteed bounds.

For a symmetric matrix S > -I with all eigenvalues in [lower, upper] and a vector v, the form v' (I + S)^-1 v is |v|^2
times the continued fraction 1 / (1 + a_1 - b_1 / (1 + a_2 - b_2 / ...)) of the coefficients that Lanczos' method finds.
After K steps the rest of the fraction, 1 / (1 + a_K - ...), is the mean of 1 / (1 + s) over a distribution of mean a_K
on [lower, upper]: at least its value at the mean, at most that of the chord. Golub and Meurant, Matrices, Moments and
Quadrature (1993).
"""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.support.arrays import Array, Single

MOST_STEPS = 6
"""Largest number of steps; single precision keeps Lanczos' vectors orthogonal for about this number."""

ROUNDING = 1e-6
"""Relative error of a form in single precision, for vectors of a few hundred numbers."""


def resolvent_forms(
    matrix: Single, change: Single, points: Single, lower: Array, upper: Array, tolerance: float
) -> tuple[Array, Array]:
    """Return the forms v' (I + S)^-1 v with S = T^1/2 E T^1/2 and v = T^1/2 E c, for every E and every c.

    Args:
        matrix: (n, n) T, between 0 and I.
        change: (h, n) diagonals of E.
        points: (k, n) c.
        lower: (h,) lower bounds of the eigenvalues of each S, in (-1, 0].
        upper: (h,) upper bounds, 0 or more.
        tolerance: error at which the computation of a form ends.

    Returns:
        (h, k) the forms and (h, k) bounds on their errors; a bound is not finite if single precision overflows.
    """
    shape = len(change), len(points)
    value, error = np.zeros(shape), np.zeros(shape)
    _resolvent_forms(matrix, change, points, lower, upper, tolerance, value, error)
    return value, error


@compiled
def _resolvent_forms(
    matrix: Single,
    change: Single,
    points: Single,
    lower: Array,
    upper: Array,
    tolerance: float,
    value: Array,
    error: Array,
) -> None:
    """Run Lanczos' method in the inner product of T, with the operator E T; forms that are done are left out."""
    n_points, n = points.shape
    active = np.arange(len(change) * n_points)
    vector, previous = np.empty((len(active), n), np.float32), np.zeros((len(active), n), np.float32)
    for r in range(len(active)):
        for i in range(n):
            vector[r, i] = change[r // n_points, i] * points[r % n_points, i]
    mean, coupling = np.zeros((MOST_STEPS, len(active))), np.zeros((MOST_STEPS, len(active)))
    norm, total, rounding = np.zeros(len(active)), np.zeros(len(active)), np.zeros(len(active))
    for step in range(MOST_STEPS):
        image = np.dot(vector[: len(active)], matrix)
        n_left = 0
        for a in range(len(active)):
            h, k = active[a] // n_points, active[a] % n_points
            length, moment, gross = np.float32(0), np.float32(0), np.float32(0)
            for i in range(n):
                gross += vector[a, i] * vector[a, i]
                length += vector[a, i] * image[a, i]
                moment += image[a, i] * image[a, i] * change[h, i]
            squared = 0.0 if length < 0 else float(length)
            if step == 0:
                total[a] = squared
            elif norm[a] > 0:
                coupling[step, a] = squared / norm[a]
            norm[a] = squared
            mean[step, a] = moment / norm[a] if norm[a] > 0 else 0.0
            last = min(max(mean[step, a], lower[h]), upper[h])
            low = 1 / (1 + last)
            high = (1 + lower[h] + upper[h] - last) / ((1 + lower[h]) * (1 + upper[h]))
            for level in range(step - 1, -1, -1):
                low = 1 / (1 + mean[level, a] - coupling[level + 1, a] * low)
                # The true denominator is positive, so another value at this end gives no bound.
                denominator = 1 + mean[level, a] - coupling[level + 1, a] * high
                high = 1 / denominator if denominator > 0 else np.inf
            if step == 0:
                # |v|^2 = u' T u may cancel, its rounding does not: T is no larger than the identity.
                rounding[a] = ROUNDING * gross
            bound = total[a] * max(high - low, 0.0) + rounding[a] * high * high
            if step > 0 and np.isnan(bound):
                # Only rounding errors are left: keep the result of the earlier steps.
                continue
            value[h, k], error[h, k] = total[a] * low, bound
            if rounding[a] == 0:
                error[h, k] = 0.0
            if error[h, k] <= tolerance:
                continue
            alpha, beta = np.float32(mean[step, a]), np.float32(coupling[step, a])
            for i in range(n):
                following = change[h, i] * image[a, i] - alpha * vector[a, i] - beta * previous[a, i]
                previous[n_left, i] = vector[a, i]
                vector[n_left, i] = following
            for level in range(step + 1):
                mean[level, n_left], coupling[level, n_left] = mean[level, a], coupling[level, a]
            norm[n_left], total[n_left], rounding[n_left] = norm[a], total[a], rounding[a]
            active[n_left] = active[a]
            n_left += 1
        active = active[:n_left]
        if n_left == 0:
            break
