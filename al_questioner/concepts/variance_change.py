"""What the posterior covariances become when the curvatures of the old examples change, W' = W (1 + E).

In the scaled coordinates of `mode_shift`, with c = T^1/2 z the covariance of the examples with a point and S = T^1/2 E
T^1/2, the variance of a point falls by z' S (I + S)^-1 z, and its covariance with another point likewise. Derived in
docs/method.md, "Look-ahead".
"""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.gaussian_process import Array, Index
from al_questioner.concepts.mode_shift import Iterate, dot
from al_questioner.concepts.quadrature import Single, resolvent_forms

VARIANCE_TOLERANCE = 4e-6
"""Error of a variance at which it counts as known; a probability then errs by no more than 2e-7."""

TANGENT_TOLERANCE = 1e-6
MAX_TANGENT_STEPS = 8

ALIGNMENT = 8
"""Numbers of single precision to a vector register; OpenBLAS multiplies other widths three times more slowly."""


def spectrum_bounds(covariance: Array, relative: Array) -> tuple[Array, Array]:
    """(|Y|, h) bounds of the eigenvalues of S, from below in (-1, 0] and from above in [0, inf).

    Args:
        covariance: (|Y|, n, n) T.
        relative: (|Y|, h, n) E.
    """
    # T lies between 0 and I, so that S reaches no farther than E. Its Frobenius norm is |S|^2 = E' (T o T) E.
    frobenius = np.sqrt(np.maximum(dot(relative, np.matmul(relative, covariance**2)), 0))
    lower = np.maximum(np.minimum(relative.min(axis=2), 0), -frobenius)
    return lower, np.minimum(np.maximum(relative.max(axis=2), 0), frobenius)


def variance_drops(
    covariance: Array, solved: Array, relative: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """By how much the variances of points fall, z' S (I + S)^-1 z.

    The first order is exact; the higher ones, z' S^2 (I + S)^-1 z, are small beside it: single precision does.

    Args:
        covariance: (|Y|, n, n) T.
        solved: (|Y|, n, k) c.
        relative: (|Y|, h, n) E.
        bounds: of the eigenvalues of S.

    Returns:
        (|Y|, h, k) the drops, and bounds on their errors.
    """
    n_symbols, n, n_points = solved.shape
    shape = (n_symbols, relative.shape[1], n_points)
    width = n + -n % ALIGNMENT
    matrix = np.zeros((n_symbols, width, width), np.float32)
    matrix[:, :n, :n] = covariance
    points = np.zeros((n_symbols, 1, n_points, width), np.float32)
    points[:, 0, :, :n] = solved.transpose(0, 2, 1)
    change = np.zeros((*shape, width), np.float32)
    change[..., :n] = relative[:, :, None]
    first_rows = np.arange(n_symbols + 1) * (shape[1] * n_points)

    def spread(vectors: Single, rows: Index) -> Single:
        if len(rows) == first_rows[-1]:
            every: Single = np.matmul(vectors.reshape(n_symbols, -1, width), matrix)
            return every.reshape(vectors.shape)
        ends = np.searchsorted(rows, first_rows)
        return np.concatenate([vectors[a:b] @ m for a, b, m in zip(ends[:-1], ends[1:], matrix, strict=True)])

    lower, upper = (np.repeat(bound.ravel(), n_points) for bound in bounds)
    rest, error = resolvent_forms(
        (change * points).reshape(-1, width), change.reshape(-1, width), spread, lower, upper, VARIANCE_TOLERANCE
    )
    return np.matmul(relative, solved**2) - rest.reshape(shape), error.reshape(shape)


def covariance_tangent(
    covariance: Array, new: Array, relative: Array, start: Array, bounds: tuple[Array, Array]
) -> tuple[Array, Array]:
    """Covariance of the old examples with the new one once their curvatures have changed: g = c - T E g.

    Args:
        covariance: (|Y|, n, n) T.
        new: (|Y|, h, n) c, of each hypothesis' new example.
        relative: (|Y|, h, n) E.
        start: (|Y|, h, n) a first guess.
        bounds: of the eigenvalues of S.

    Returns:
        (|Y|, h, n) g, and (|Y|, h) a bound on the error of z' S (I + S)^-1 z* for a unit z.
    """
    lower, upper = bounds
    scale = np.maximum(upper, -lower) / (1 + lower)
    bend, previous = relative * start, None
    for step in range(1, MAX_TANGENT_STEPS + 1):
        tangent = new - np.matmul(bend, covariance)
        image = relative * tangent
        iterate = Iterate.of(image, bend)
        error = scale * np.sqrt(iterate.squared)
        if step == MAX_TANGENT_STEPS or error.max() <= TANGENT_TOLERANCE:
            break
        bend = iterate.following(previous)
        previous = iterate
    return tangent, error
