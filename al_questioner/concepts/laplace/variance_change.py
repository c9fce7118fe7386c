"""Change of the posterior covariances when the curvatures of the old examples change, W' = W (1 + E).

In the scaled coordinates of `mode_shift`, with c and d the covariances of the examples with two points, the covariance
of the points falls by c' (E^-1 + T)^-1 d. For any guess u of (E^-1 + T)^-1 d, with q = d - T u and the residual
r = E q - u, that is c' u + q_c' r_d up to r_c' T' r_d, where T' = (T^-1 + E)^-1 lies below (I + E)^-1: the error is of
second order in the residuals, and known to be small without any bound of eigenvalues. Derived in
docs/explanation/look_ahead.md.
"""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.laplace.active_set import (
    LARGEST_PASSIVE,
    LOWER,
    SLOW,
    factorise,
    select_active,
    substitute,
)
from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.concepts.laplace.gaussian_process import slope_in_variance
from al_questioner.support.arrays import Array, Index

MOST_STEPS = 30
ROWS_AT_ONCE = 512
"""Right hand sides that are iterated together: enough for matrix products at full speed."""

_slope_in_variance = compiled(slope_in_variance)


def find_variances(
    covariance: Array,
    points: Array,
    relative: Array,
    own: Index,
    curvature: Array,
    variance: Array,
    cross: Array,
    tolerance: float,
    steps: int = MOST_STEPS,
) -> tuple[Array, Array]:
    """Find the variances of points once one of them is an example, which changes the curvatures of the others.

    Args:
        covariance: (|Y|, n, n) T.
        points: (|Y|, k, n) covariances of the points with the examples, scaled.
        relative: (|Y|, h, n) E.
        own: (h,) the point that each hypothesis makes an example.
        curvature: (|Y|, h) of the new example.
        variance: (|Y|, k) variances of the points before.
        cross: (|Y|, h, k) covariances of the new example with the points before.
        tolerance: error of a probability at which its variance is known well enough.
        steps: most products with T.

    Returns:
        (|Y|, h, k) variances, and bounds on their errors.
    """
    points, relative, cross = map(np.ascontiguousarray, (points, relative, cross))
    found, error = np.empty_like(cross), np.empty_like(cross)
    for y in range(len(points)):
        _find_variances(
            covariance[y],
            points[y],
            relative[y],
            own,
            curvature[y],
            variance[y],
            cross[y],
            tolerance,
            steps,
            found[y],
            error[y],
        )
    return found, error


@compiled
def _find_variances(
    covariance: Array,
    points: Array,
    relative: Array,
    own: Index,
    curvature: Array,
    variance: Array,
    cross: Array,
    tolerance: float,
    steps: int,
    found: Array,
    error: Array,
) -> None:
    """Find the variances of one classifier; a hypothesis whose variances are known takes no part in further steps."""
    n_hypotheses, n = relative.shape
    n_points = len(points)
    at_once = max(1, min(n_hypotheses, ROWS_AT_ONCE // n_points))
    guess, value = np.empty((at_once, n_points, n)), np.empty((at_once, n_points, n))
    matrices, pivots = np.empty((at_once, n, n)), np.empty((at_once, n), np.intp)
    rows, sizes = np.empty((at_once, n), np.intp), np.empty(at_once, np.intp)
    exact, scale, damping = np.empty((n_points, n)), np.empty((at_once, n)), np.empty((at_once, n))
    drops, joint, squared = np.empty(n_points), np.empty(n_points), np.empty(n_points)
    limit, before = np.empty(at_once), np.empty(at_once)
    for first in range(0, n_hypotheses, at_once):
        active = np.arange(min(at_once, n_hypotheses - first))
        for a in range(len(active)):
            h = first + a
            limit[a], before[a] = LARGEST_PASSIVE, np.inf
            for i in range(n):
                scale[a, i] = 1 / (1 + relative[h, i])
                damping[a, i] = 1 / (1 + relative[h, i] * covariance[i, i])
            sizes[a] = _factorise_active(covariance, relative[h], limit[a], rows[a], matrices[a], pivots[a])
            for k in range(n_points):
                for i in range(n):
                    guess[a, k, i] = relative[h, i] * points[k, i] * damping[a, i]
                for x in range(sizes[a]):
                    guess[a, k, rows[a, x]] = 0.0
        for step in range(1, steps + 1):
            passive = guess[: len(active)].reshape(len(active) * n_points, n)
            spread = np.dot(passive, covariance).reshape(len(active), n_points, n)
            n_left = 0
            for a in range(len(active)):
                slot = active[a]
                h, size = first + slot, sizes[slot]
                for k in range(n_points):
                    for x in range(size):
                        i = rows[slot, x]
                        exact[k, x] = relative[h, i] * (points[k, i] - spread[a, k, i])
                    substitute(matrices[slot], pivots[slot], size, exact[k])
                    for i in range(n):
                        value[a, k, i] = points[k, i] - spread[a, k, i]
                    for x in range(size):
                        i = rows[slot, x]
                        guess[a, k, i] = exact[k, x]
                        for j in range(n):
                            value[a, k, j] -= covariance[i, j] * exact[k, x]
                new = own[h]
                change, bound, new_point, new_value = relative[h], scale[slot], points[new], value[a, new]
                for k in range(n_points):
                    # One pass over the examples, as it is this that takes the time beside the products.
                    drop, common, length = 0.0, 0.0, 0.0
                    for i in range(n):
                        u, q = guess[a, k, i], value[a, k, i]
                        residual = change[i] * q - u
                        drop += points[k, i] * u + q * residual
                        common += new_point[i] * u + new_value[i] * residual
                        length += residual * residual * bound[i]
                    drops[k], joint[k], squared[k] = drop, cross[h, k] - common, length
                weight = curvature[h] / (1 + curvature[h] * (variance[new] - drops[new]))
                is_known, largest = True, 0.0
                for k in range(n_points):
                    found[h, k] = variance[k] - drops[k] - weight * joint[k] * joint[k]
                    error[h, k] = (np.sqrt(squared[k]) + weight * abs(joint[k]) * np.sqrt(squared[new])) ** 2
                    of_probability = _slope_in_variance(np.maximum(found[h, k], 0)) * error[h, k]
                    largest = max(largest, of_probability)
                    # Not known either if it is not a number.
                    if not of_probability <= tolerance:
                        is_known = False
                if is_known or step == steps:
                    continue
                if largest > SLOW * before[slot]:
                    limit[slot] *= LOWER
                    size = _factorise_active(
                        covariance, relative[h], limit[slot], rows[slot], matrices[slot], pivots[slot]
                    )
                    sizes[slot] = size
                before[slot] = largest
                for k in range(n_points):
                    for i in range(n):
                        u = guess[a, k, i]
                        guess[n_left, k, i] = u + (relative[h, i] * value[a, k, i] - u) * damping[slot, i]
                    for x in range(size):
                        guess[n_left, k, rows[slot, x]] = 0.0
                active[n_left] = slot
                n_left += 1
            active = active[:n_left]
            if n_left == 0:
                break


@compiled
def _factorise_active(
    covariance: Array, relative: Array, limit: float, rows: Index, matrix: Array, pivots: Index
) -> int:
    """Write the rows of the active set and the factors of its system (I + E T), and return its size."""
    size = int(select_active(covariance, relative, limit, rows))
    for x in range(size):
        i = rows[x]
        for z in range(size):
            matrix[x, z] = relative[i] * covariance[i, rows[z]]
        matrix[x, x] += 1
    factorise(matrix, pivots, size)
    return size
