"""Predictions of the classifiers after one more example, without a new fit.

A hypothesis is an object and whether it is a positive or a negative example of a classifier. Along the axis of
hypotheses (2e of them for e objects), all objects come first as negative examples, then all as positive ones. Arrays
over the n examples are scaled as in `mode_shift`. Derived in docs/explanation/look_ahead.md.
"""

from __future__ import annotations

import numpy as np
from scipy.special import expit

from al_questioner.concepts.laplace.gaussian_process import expected_logistic, find_modes, predict_probabilities
from al_questioner.concepts.laplace.mode_shift import MOST_MODE_STEPS, find_shift
from al_questioner.concepts.laplace.posterior import Marginals, Posterior
from al_questioner.concepts.laplace.variance_change import covariance_tangent, spectrum_bounds, variance_drops
from al_questioner.support.arrays import Array, Index

PROBABILITY_TOLERANCE = 8e-7
"""Largest error bound of a probability that is not computed by refitting."""

SLOPE_IN_MEAN = 0.25
SLOPE_IN_VARIANCE = 0.0488
"""Largest derivatives of the expected logistic function, as the five-term sum has them.

The exact function has 1/4 in the mean, and max |logistic''| / 2 = 0.0481 in the variance.
"""

MAX_REFIT_NUMBERS = 1_000_000
"""Largest stack of kernel matrices that is refitted at once, in numbers: about 50 MB."""


def predict_each(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, exact: bool
) -> Array:
    """Return predictions for all points of a scene if each of some of its objects, alone, were an example.

    Args:
        posterior: posteriors without the example.
        marginals: marginals of the k points of the scene.
        things: (e,) the points that are hypothetical examples.
        prior: (e, k) their prior covariance with all points.
        amplitude: prior variance of a point.
        exact: refit the hypotheses that are not within `PROBABILITY_TOLERANCE`; False stops after the first step of the
            modes and the first moment of the variances.

    Returns:
        (|Y|, 2e, k) probability of the positive class.
    """
    # A hypothesis that overflows or divides by zero at large amplitudes has no finite bound, and is refitted.
    with np.errstate(all='ignore'):
        probabilities, error = _predict(posterior, marginals, things, prior, amplitude, exact)
    if exact:
        symbols, hypotheses = np.nonzero(~(error <= PROBABILITY_TOLERANCE))
        size = len(posterior.kernel) + 1
        per_batch = max(1, MAX_REFIT_NUMBERS // (size * (size + prior.shape[1])))
        for first in range(0, len(symbols), per_batch):
            y, h = symbols[first : first + per_batch], hypotheses[first : first + per_batch]
            probabilities[y, h] = _refit(posterior, marginals, things, prior, amplitude, y, h)
    return probabilities


def _predict(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, exact: bool
) -> tuple[Array, Array]:
    """Return probabilities as `predict_each`, and (|Y|, 2e) a bound on the error of each hypothesis, if `exact`."""
    both = np.concatenate([things, things])
    twice = np.tile(np.arange(len(things)), 2)
    new = np.ascontiguousarray(marginals.solved.transpose(0, 2, 1)[:, both])
    variance = amplitude - marginals.explained
    cross = marginals.covariance(things, prior)[:, twice]
    targets = np.repeat([0.0, 1.0], len(things))
    steps = MOST_MODE_STEPS if exact else 1
    shift = find_shift(posterior, new, variance[:, both], marginals.mean[:, both], targets, steps)
    mean = marginals.mean[:, None] + cross * shift.pull[:, :, None] - np.matmul(shift.bend, marginals.solved)

    # First without the curvature of the new example: the curvatures of the old ones change ...
    if exact and posterior.modes.size:
        bounds = spectrum_bounds(posterior.single, shift.relative)
        drops, own_error = variance_drops(posterior.single, marginals.solved, shift.relative, bounds)
        start = shift.change / shift.pull[:, :, None]
        tangent, joint_error = covariance_tangent(posterior.covariance, new, shift.relative, start, bounds)
    else:
        drops, tangent = np.matmul(shift.relative, marginals.solved**2), new
        own_error, joint_error = np.zeros_like(drops), np.zeros_like(shift.pull)
    own = variance[:, None] - drops
    joint = cross - np.matmul(shift.relative * tangent, marginals.solved)
    # ... then as one more observation (R&W equation 3.24 for a single example).
    p = expit(shift.latent)[:, :, None]
    weight = p * (1 - p) / (1 + p * (1 - p) * _at_new(own, both))
    pulled = weight * np.abs(joint)
    probabilities = expected_logistic(mean, own - weight * joint**2)

    joint_errors = joint_error[:, :, None] * np.sqrt(variance)[:, None]
    variance_error = own_error + 2 * pulled * joint_errors + pulled**2 * _at_new(own_error, both)
    largest = np.maximum(variance.max(axis=1)[:, None], own.max(axis=2))
    # An error of the modes by d deviations changes the curvatures, and the variances, by a share of d sqrt(amplitude).
    mode_error = shift.error * (SLOPE_IN_MEAN * np.sqrt(largest) + SLOPE_IN_VARIANCE * largest * np.sqrt(amplitude))
    return probabilities, mode_error + SLOPE_IN_VARIANCE * variance_error.max(axis=2)


def _refit(
    posterior: Posterior, marginals: Marginals, things: Index, prior: Array, amplitude: float, y: Index, h: Index
) -> Array:
    """Return (F, k) predictions of the classifiers y under the hypotheses h, F of each, fitted from scratch."""
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
    """Return (..., h, 1) of (..., h, k) values at the points: the value at each hypothesis' own new example."""
    return values[..., np.arange(len(both)), both][..., None]
