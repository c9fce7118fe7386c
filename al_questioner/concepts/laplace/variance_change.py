"""Change of the posterior covariances when the curvatures of the old examples change, W' = W (1 + E).

In the scaled coordinates of `mode_shift`, with c = T^1/2 z the covariance of the examples with a point and S = T^1/2 E
T^1/2, the variance of a point falls by z' S (I + S)^-1 z, and its covariance with another point likewise. Derived in
docs/explanation/look_ahead.md.
"""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.laplace.compiled import compiled, touch_packing_buffers
from al_questioner.concepts.laplace.fixed_point import extrapolate
from al_questioner.concepts.laplace.quadrature import ROUNDING, resolvent_forms
from al_questioner.support.arrays import Array, Single

VARIANCE_TOLERANCE = 8e-6
"""Error of a variance at which its computation ends; a probability then has an error of at most 4e-7."""

TANGENT_TOLERANCE = 1e-6
MOST_TANGENT_STEPS = 12


def spectrum_bounds(covariance: Array | Single, relative: Array) -> tuple[Array, Array]:
    """Return (|Y|, h) bounds of the eigenvalues of S, from below in (-1, 0] and from above in [0, inf).

    Args:
        covariance: (|Y|, n, n) T; single precision is enough.
        relative: (|Y|, h, n) E.
    """
    # T lies between 0 and I, so the range of E bounds that of S. Its Frobenius norm is |S|^2 = E' (T o T) E.
    change = relative.astype(np.float32)
    squares = np.asarray(covariance, np.float32) ** 2
    squared = np.einsum('yhn,yhn->yh', change, np.matmul(change, squares))
    # The sum may cancel, its rounding does not.
    rounding = ROUNDING * squares.sum(axis=(1, 2))[:, None] * np.abs(change).max(axis=2) ** 2
    frobenius = np.sqrt(np.maximum(squared, 0) + rounding).astype(np.float64)
    lower = np.maximum(np.minimum(relative.min(axis=2), 0), -frobenius)
    return lower, np.minimum(np.maximum(relative.max(axis=2), 0), frobenius)


def variance_drops(
    covariance: Array | Single, solved: Array, relative: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return the decrease of the variances of points, z' S (I + S)^-1 z.

    The first order is exact. The higher ones, z' S^2 (I + S)^-1 z, are small beside it, so single precision is enough.

    Args:
        covariance: (|Y|, n, n) T; single precision is enough.
        solved: (|Y|, n, k) c.
        relative: (|Y|, h, n) E.
        bounds: bounds of the eigenvalues of S.

    Returns:
        (|Y|, h, k) the decreases, and bounds on their errors.
    """
    touch_packing_buffers()
    matrix, change = np.asarray(covariance, np.float32), relative.astype(np.float32)
    points = np.ascontiguousarray(solved.transpose(0, 2, 1), dtype=np.float32)
    forms = [
        resolvent_forms(matrix[y], change[y], points[y], bounds[0][y], bounds[1][y], VARIANCE_TOLERANCE)
        for y in range(len(solved))
    ]
    rest, error = (np.stack(part) for part in zip(*forms, strict=True))
    return np.matmul(relative, solved**2) - rest, error


def covariance_tangent(
    covariance: Array, new: Array, relative: Array, start: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Return the covariance of the old examples with the new one after their curvatures have changed: q = c - T E q.

    Args:
        covariance: (|Y|, n, n) T.
        new: (|Y|, h, n) c, of each hypothesis' new example.
        relative: (|Y|, h, n) E.
        start: (|Y|, h, n) a first guess.
        bounds: bounds of the eigenvalues of S.

    Returns:
        (|Y|, h, n) q, and (|Y|, h) a bound on the error of z' S (I + S)^-1 z* for a unit z.
    """
    lower, upper = bounds
    new, relative, start = map(np.ascontiguousarray, (new, relative, start))
    scale = np.maximum(upper, -lower) / (1 + lower)
    tangent, error = np.empty_like(new), np.empty_like(scale)
    for y in range(len(new)):
        _find_tangents(covariance[y], new[y], relative[y], start[y], scale[y], tangent[y], error[y])
    return tangent, error


@compiled
def _find_tangents(
    covariance: Array, new: Array, relative: Array, start: Array, scale: Array, tangent: Array, error: Array
) -> None:
    """Compute `covariance_tangent` for one classifier, iterated as in `mode_shift`."""
    n_hypotheses, n = new.shape
    guess = np.empty((n_hypotheses, n))
    for h in range(n_hypotheses):
        for i in range(n):
            guess[h, i] = relative[h, i] * start[h, i]
    image, residual = np.zeros((n_hypotheses, n)), np.zeros((n_hypotheses, n))
    squared = np.zeros(n_hypotheses)
    active = np.arange(n_hypotheses)
    for _ in range(MOST_TANGENT_STEPS):
        spread = np.dot(guess[: len(active)], covariance)
        n_left = 0
        for a in range(len(active)):
            h = active[a]
            length, common = 0.0, 0.0
            for i in range(n):
                tangent[h, i] = new[h, i] - spread[a, i]
                difference = relative[h, i] * tangent[h, i] - guess[a, i]
                length += difference * difference
                common += difference * residual[a, i]
            error[h] = scale[h] * np.sqrt(length)
            if error[h] <= TANGENT_TOLERANCE:
                continue
            extrapolate((guess, image, residual, squared), a, n_left, relative[h] * tangent[h], length, common)
            active[n_left] = h
            n_left += 1
        active = active[:n_left]
        if n_left == 0:
            break
