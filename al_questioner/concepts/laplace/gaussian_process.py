"""Binary Gaussian process classification: Laplace approximation, logistic link, many problems solved at once.

Equations and algorithms are those of Rasmussen and Williams, Gaussian Processes for Machine Learning (2006), chapter 3
(below: R&W). A *problem* is a kernel matrix and a vector of targets. Each problem names its kernel by an index, its
`owners` entry, so that |Y| classifiers on the same data share one matrix.
"""

from __future__ import annotations

import numpy as np

from al_questioner.support.arrays import Array, Index
from al_questioner.support.late_imports import late

erf = late('scipy.special', 'erf')
expit = late('scipy.special', 'expit')

STEP_TOLERANCE = 1e-5
"""Largest change of a latent value in the last full Newton step; the next step would be about its square."""

MAX_NEWTON_STEPS = 100
MAX_HALVINGS = 40

SUFFICIENT_INCREASE = 1e-4
"""Smallest share of the predicted increase that a step must achieve."""

LOGISTIC_SLOPES = np.array([0.41, 0.40, 0.37, 0.44, 0.39])
LOGISTIC_COEFFICIENTS = np.array([-1854.8214151, 3516.89893646, 221.29346712, 128.12323805, -2010.49422654])
"""Coefficients of the logistic function as a sum of five error functions.

Source: Williams and Barber, Bayesian Classification with Gaussian Processes (1998), appendix A, with the constants of
scikit-learn.
"""

MEAN_SLOPE = (0.4, 2.55)
VARIANCE_SLOPE = (0.1225, 2.5)
"""Coefficients of bounds on the derivatives of the expected logistic function, as the five-term sum has them."""

PROBABILITY_MARGIN = 1e-9
"""Smallest distance of a probability from 0 and 1; by rounding, the five-term sum exceeds (0, 1) by up to 5e-13."""


def find_modes(kernels: Array, owners: Index, targets: Array, start: Array) -> Array:
    """Return the modes of the posteriors p(f | X, y), by Newton's method (R&W algorithm 3.1) with step halving.

    The log posterior is concave and every accepted step raises it, so the method converges from any start, even if
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
    """Return the averaged predictive probability of the positive class (R&W algorithm 3.2, equation 3.25).

    Args:
        kernels: (K, n, n) kernel matrices.
        owners: (H,) the kernel of each problem.
        targets: (H, n) 1 for a positive, 0 for a negative example.
        modes: (H, n) result of `find_modes`.
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
    """Return B = I + W^1/2 K W^1/2 (R&W equation 3.26): its eigenvalues lie between 1 and 1 + n max(K) / 4.

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
    """Return the full Newton step in K^-1 f and in f (R&W algorithm 3.1, lines 4 to 8)."""
    probability = expit(latent)
    curvature = probability * (1 - probability)
    root = np.sqrt(curvature)
    b = curvature * latent + targets - probability
    kernel_b = np.einsum('hij,hj->hi', kernel, b)
    solved = np.linalg.solve(well_conditioned(kernel, root), (root * kernel_b)[:, :, None])[:, :, 0]
    alpha_step = b - root * solved - alpha
    return alpha_step, np.einsum('hij,hj->hi', kernel, alpha_step)


def _step_lengths(alpha: Array, latent: Array, targets: Array, alpha_step: Array, latent_step: Array) -> Array:
    """Return (H,) the largest of 1, 1/2, 1/4 ... with which each problem's step raises its log posterior enough.

    Enough is a share of the increase that the slope predicts (Armijo's rule). Otherwise the next step could undo a step
    that gains nothing, without end.
    """
    before = _log_posterior(alpha, latent, targets)
    p = expit(latent)
    # For Newton's step the slope is the step's squared length in the metric of the Hessian, K^-1 + W.
    slope = np.einsum('hn,hn->h', alpha_step + p * (1 - p) * latent_step, latent_step)
    # A converged problem gains less than the rounding of its objective; such a step is not halved.
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
    """Return (H,) log p(f | X, y) up to a constant (R&W equation 3.12)."""
    log_prior: Array = -0.5 * np.einsum('hn,hn->h', alpha, latent)
    log_likelihood: Array = -np.logaddexp(0, (1 - 2 * targets) * latent).sum(axis=1)
    return log_prior + log_likelihood


def expected_logistic(mean: Array, variance: Array) -> Array:
    """Return the mean of the logistic function of normal variables, by the five terms of Williams and Barber.

    Args:
        mean: (...) means.
        variance: (...) variances; a value below 0, from rounding, counts as 0.

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
