"""Predictions of the classifiers after one more example, without fitting them again.

A hypothesis is a thing and whether it is a positive or a negative example of a classifier. Along the axis of hypotheses
(2e of them for e things) come first all things as negative examples, then all as positive ones. Arrays over the n
examples are scaled as in `mode_shift`. Derived in docs/explanation/look_ahead.md.
"""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from al_questioner.concepts.laplace.gaussian_process import (
    MEAN_SLOPE,
    VARIANCE_SLOPE,
    expected_logistic,
    find_modes,
    predict_probabilities,
    slope_in_variance,
)
from al_questioner.concepts.laplace.mode_shift import MOST_MODE_STEPS, find_shift
from al_questioner.concepts.laplace.posterior import Marginals, Posterior
from al_questioner.concepts.laplace.variance_change import find_variances
from al_questioner.support.arrays import Array, Index

MAX_REFIT_NUMBERS = 1_000_000
"""Largest stack of kernel matrices that is refitted at once, in numbers: bounds its memory to some 50 MB."""

ROUGH_STEPS = 3
ROUGH_TOLERANCE = 1e-3
"""Most steps of an approximate look-ahead in search of the modes, and the distance from them at which it ends."""


def predict_each(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, tolerance: float | None
) -> Array:
    """Return the predictions for all points of a scene had each of some of its things been an example.

    Args:
        posterior: without the example.
        marginals: of the k points of the scene.
        things: (e,) the points that are hypothetical examples.
        prior: (e, k) their prior covariance with all points.
        amplitude: prior variance of a point.
        tolerance: a hypothesis whose probabilities may be off by more is refitted; None stops after a few steps of the
            modes and the first guess of the variances, and refits nothing.

    Returns:
        (|Y|, 2e, k) probability of the positive class.
    """
    # What overflows or divides by zero at large amplitudes has no finite bound, and is refitted.
    with np.errstate(all='ignore'):
        probabilities, error = _predict(posterior, marginals, things, prior, amplitude, tolerance)
    if tolerance is not None:
        symbols, hypotheses = np.nonzero(~(error <= tolerance))
        size = len(posterior.kernel) + 1
        per_batch = max(1, MAX_REFIT_NUMBERS // (size * (size + prior.shape[1])))
        for first in range(0, len(symbols), per_batch):
            y, h = symbols[first : first + per_batch], hypotheses[first : first + per_batch]
            probabilities[y, h] = _refit(posterior, marginals, things, prior, amplitude, y, h)
    return probabilities


def _predict(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, tolerance: float | None
) -> tuple[Array, Array]:
    """Return probabilities as `predict_each` does, and, with a tolerance, (|Y|, 2e) bounds on their errors."""
    both, twice = np.tile(things, 2), np.tile(np.arange(len(things)), 2)
    points = marginals.solved.transpose(0, 2, 1)
    variance = amplitude - marginals.explained
    cross = marginals.covariance(things, prior)[:, twice]
    targets = np.repeat([0.0, 1.0], len(things))
    # Half of the tolerance is for the modes, half for the variances.
    mode_weight = MEAN_SLOPE[0] + VARIANCE_SLOPE[0] * np.sqrt(amplitude)
    of_modes, steps = (
        (ROUGH_TOLERANCE, ROUGH_STEPS) if tolerance is None else (tolerance / 2 / mode_weight, MOST_MODE_STEPS)
    )
    shift = find_shift(posterior, points[:, both], variance[:, both], marginals.mean[:, both], targets, of_modes, steps)
    mean = marginals.mean[:, None] + cross * shift.pull[:, :, None] - np.matmul(shift.bend, marginals.solved)
    p = expit(shift.latent)
    curvature = p * (1 - p)
    if tolerance is None:
        # The first guess of `find_variances`: the curvature of each example changes as if it were the only one.
        alone = shift.relative / (1 + shift.relative * np.diagonal(posterior.covariance, axis1=1, axis2=2)[:, None])
        own = np.maximum(variance[:, None] - np.matmul(alone, marginals.solved**2), 0)
        joint = cross - np.matmul(alone * points[:, both], marginals.solved)
        weight = curvature[:, :, None] / (1 + curvature[:, :, None] * _at_new(own, both))
        return expected_logistic(mean, own - weight * joint**2), np.zeros_like(p)
    found, error = find_variances(
        posterior.covariance, points, shift.relative, both, curvature, variance, cross, tolerance / 2
    )
    probability_error = slope_in_variance(np.maximum(found, 0)) * error
    # Modes that are off by d deviations change the curvatures, and so the variances, by a share of d sqrt(amplitude).
    return expected_logistic(mean, found), shift.error * mode_weight + probability_error.max(axis=2)


def _refit(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, y: Index, h: Index
) -> Array:
    """Return the (F, k) predictions of the classifiers y under the hypotheses h, F of each, fitted from scratch."""
    n, k = posterior.modes.shape[1], prior.shape[1]
    example = h % len(things)
    old_cross = marginals.cross
    kernels = np.empty((len(y), n + 1, n + 1))
    kernels[:, :n, :n] = posterior.kernel
    kernels[:, :n, n] = kernels[:, n, :n] = old_cross[:, things[example]].T
    kernels[:, n, n] = amplitude
    cross = np.empty((len(y), n + 1, k))
    cross[:, :n] = old_cross
    cross[:, n] = prior[example]
    targets = np.concatenate([posterior.targets[y], (h >= len(things))[:, None]], axis=1).astype(np.float64)
    start = np.concatenate([posterior.gradient[y], np.zeros((len(y), 1))], axis=1)
    owners = np.arange(len(y))
    modes = find_modes(kernels, owners, targets, start)
    return predict_probabilities(kernels, owners, targets, modes, cross, amplitude)


def _at_new(values: Array, both: Index) -> Array:
    """Return (..., h, 1) of (..., h, k) values at the points: that at each hypothesis' own new example."""
    return values[..., np.arange(len(both)), both][..., None]
