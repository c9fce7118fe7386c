"""Binary Gaussian process classification: Laplace approximation, logistic link, many problems solved at once.

Equations and algorithms are those of Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), chapter 3
(below: R&W). A *problem* is a kernel matrix and a vector of targets. Problems that share a kernel name it by its index,
their `owners` entry, so that |Y| classifiers on the same data hold one matrix between them.
"""

from __future__ import annotations

import numpy as np

from al_questioner.domain import FloatArray
from al_questioner.support.arrays import Array, Index
from al_questioner.support.late_imports import late

cdist = late('scipy.spatial.distance', 'cdist')
erf = late('scipy.special', 'erf')
expit = late('scipy.special', 'expit')

STEP_TOLERANCE = 1e-5
"""Newton has converged once a full step moves no latent value by more; the next one would move it by the square."""

MAX_NEWTON_STEPS = 100
MAX_HALVINGS = 40

SUFFICIENT_INCREASE = 1e-4
"""Share of the increase that a step promises which it has to bring."""

LOGISTIC_SLOPES = np.array([0.41, 0.40, 0.37, 0.44, 0.39])
LOGISTIC_COEFFICIENTS = np.array([-1854.8214151, 3516.89893646, 221.29346712, 128.12323805, -2010.49422654])
"""The logistic function as a sum of five error functions: Williams and Barber, Bayesian Classification with Gaussian
Processes (1998), appendix A, with the constants of scikit-learn."""

MEAN_SLOPE = (0.4, 2.55)
VARIANCE_SLOPE = (0.1225, 2.5)
"""Coefficients of bounds on the derivatives of the expected logistic function, as the five-term sum has them."""

PROBABILITY_MARGIN = 1e-9
"""The five-term sum leaves (0, 1) by rounding, up to 5e-13; probabilities are kept this far inside."""


def rbf_kernel(first: FloatArray, second: FloatArray, amplitude: float, length_scale: float) -> Array:
    """Covariance amplitude * exp(-d^2 / (2 length_scale^2)) of every pair of rows.

    Args:
        first: (n, m) points.
        second: (k, m) points.
        amplitude: variance of the process.
        length_scale: in the unit of the points.

    Returns:
        (n, k) covariances.
    """
    # Differences, not |a|^2 + |b|^2 - 2ab: rounding there would give duplicated points a distance.
    squared = cdist(first, second, 'sqeuclidean')
    covariance: Array = amplitude * np.exp(squared * (-0.5 / length_scale**2))
    return covariance


def find_modes(kernels: Array, owners: Index, targets: Array, start: Array) -> Array:
    """Modes of the posteriors p(f | X, y), by Newton's method (R&W algorithm 3.1) with step halving.

    The log posterior is concave and every accepted step raises it, so the method converges from anywhere, also where
    the plain iteration would oscillate (large amplitudes, duplicated points with opposite targets).

    Args:
        kernels: (K, n, n) kernel matrices.
        owners: (H,) the kernel of each problem.
        targets: (H, n) 1 for a positive, 0 for a negative example.
        start: (H, n) first guess of K^-1 f.

    Returns:
        (H, n) latent values f at the mode.

    Raises:
        ArithmeticError: no convergence, which only input that is not finite or not a covariance can cause.
    """
    alpha = start.copy()
    latent: Array = np.einsum('hij,hj->hi', kernels[owners], alpha)
    active = np.arange(len(owners))
    for _ in range(MAX_NEWTON_STEPS):
        kernel, a, f, y = kernels[owners[active]], alpha[active], latent[active], targets[active]
        alpha_step, latent_step = _newton_step(kernel, a, f, y)
        length = _step_lengths(a, f, y, alpha_step, latent_step)[:, None]
        alpha[active] = a + length * alpha_step
        latent[active] = f + length * latent_step
        active = active[~(np.abs(latent_step).max(axis=1, initial=0.0) <= STEP_TOLERANCE)]
        if active.size == 0:
            return latent
    raise ArithmeticError(f'no posterior mode for {active.size} problems after {MAX_NEWTON_STEPS} Newton steps')


def predict_probabilities(
    kernels: Array, owners: Index, targets: Array, modes: Array, cross: Array, amplitude: float
) -> Array:
    """Averaged predictive probability of the positive class (R&W algorithm 3.2, equation 3.25).

    Args:
        kernels: (K, n, n) kernel matrices.
        owners: (H,) the kernel of each problem.
        targets: (H, n) 1 for a positive, 0 for a negative example.
        modes: (H, n) what `find_modes` returned.
        cross: (K, n, k) covariances of the n training points with k test points.
        amplitude: prior variance of a test point.

    Returns:
        (H, k) probabilities, inside (0, 1).
    """
    probability = expit(modes)
    root = np.sqrt(probability * (1 - probability))
    mean = np.einsum('hn,hnk->hk', targets - probability, cross[owners])
    scaled = root[:, :, None] * cross[owners]
    explained = np.einsum('hnk,hnk->hk', scaled, np.linalg.solve(well_conditioned(kernels[owners], root), scaled))
    return expected_logistic(mean, amplitude - explained)


def well_conditioned(kernel: Array, root: Array) -> Array:
    """B = I + W^1/2 K W^1/2 (R&W equation 3.26): its eigenvalues lie between 1 and 1 + n max(K) / 4.

    Args:
        kernel: (H, n, n) K, or (n, n) for all.
        root: (H, n) W^1/2.

    Returns:
        (H, n, n).
    """
    matrix = root[:, :, None] * kernel * root[:, None, :]
    diagonal = np.arange(kernel.shape[-1])
    matrix[:, diagonal, diagonal] += 1
    return matrix


def _newton_step(kernel: Array, alpha: Array, latent: Array, targets: Array) -> tuple[Array, Array]:
    """The full Newton step in K^-1 f and in f (R&W algorithm 3.1, lines 4 to 8)."""
    probability = expit(latent)
    curvature = probability * (1 - probability)
    root = np.sqrt(curvature)
    b = curvature * latent + targets - probability
    kernel_b = np.einsum('hij,hj->hi', kernel, b)
    solved = np.linalg.solve(well_conditioned(kernel, root), (root * kernel_b)[:, :, None])[:, :, 0]
    alpha_step = b - root * solved - alpha
    return alpha_step, np.einsum('hij,hj->hi', kernel, alpha_step)


def _step_lengths(alpha: Array, latent: Array, targets: Array, alpha_step: Array, latent_step: Array) -> Array:
    """(H,) largest of 1, 1/2, 1/4 ... with which each problem's step raises its log posterior as it should.

    That is by a share of what the slope promises (Armijo's rule): a step that gains nothing could be taken back by the
    next, for ever.
    """
    before = _log_posterior(alpha, latent, targets)
    p = expit(latent)
    # For Newton's step the slope is the step's squared length in the metric of the Hessian, K^-1 + W.
    slope = np.einsum('hn,hn->h', alpha_step + p * (1 - p) * latent_step, latent_step)
    # A converged problem gains less than the rounding of its objective: that is no reason to halve.
    floor = before - 1e-12 * (1 + np.abs(before))
    length = np.ones(len(alpha))
    for _ in range(MAX_HALVINGS):
        scale = length[:, None]
        after = _log_posterior(alpha + scale * alpha_step, latent + scale * latent_step, targets)
        worse = after < floor + SUFFICIENT_INCREASE * length * slope
        if not worse.any():
            break
        length[worse] /= 2
    return length


def _log_posterior(alpha: Array, latent: Array, targets: Array) -> Array:
    """(H,) log p(f | X, y) up to a constant (R&W equation 3.12)."""
    log_prior: Array = -0.5 * np.einsum('hn,hn->h', alpha, latent)
    log_likelihood: Array = -np.logaddexp(0, (1 - 2 * targets) * latent).sum(axis=1)
    return log_prior + log_likelihood


def expected_logistic(mean: Array, variance: Array) -> Array:
    """Mean of the logistic function of normal variables, by the five-term approximation of Williams and Barber.

    Args:
        mean: (...) means.
        variance: (...) variances; rounding below 0 counts as 0.

    Returns:
        (...) probabilities, inside (0, 1).
    """
    # E[erf(s z)] = erf(s mean / sqrt(1 + 2 s^2 variance)) for z normal, and each logistic term is (1 + erf) / 2.
    slope = LOGISTIC_SLOPES.reshape(-1, *[1] * mean.ndim)
    terms = erf(slope * mean / np.sqrt(1 + 2 * slope**2 * np.maximum(variance, 0)))
    expected: Array = 0.5 * (np.tensordot(LOGISTIC_COEFFICIENTS, terms, axes=1) + LOGISTIC_COEFFICIENTS.sum())
    return np.clip(expected, PROBABILITY_MARGIN, 1 - PROBABILITY_MARGIN)


def slope_in_mean(variance: Array) -> Array:
    """Return (...) bounds of the derivative of the expected logistic function by the mean, over all means."""
    return MEAN_SLOPE[0] / np.sqrt(variance + MEAN_SLOPE[1])


def slope_in_variance(variance: Array) -> Array:
    """Return (...) bounds of the derivative of the expected logistic function by the variance, over all means."""
    return VARIANCE_SLOPE[0] / (variance + VARIANCE_SLOPE[1])
