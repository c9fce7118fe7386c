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
dpotrf = late('scipy.linalg.lapack', 'dpotrf')
dpotrs = late('scipy.linalg.lapack', 'dpotrs')

STEP_TOLERANCE = 1e-7
"""Largest change of a latent value in the last step; the next step would be no more than a fifth of it."""

STALE_STEP = 0.15
"""Change of a latent value by a step after which the curvatures are computed again; smaller ones change them little."""

MAX_NEWTON_STEPS = 100
MAX_TRIALS = 60

FLAT_SHARE = 0.02
"""Share of the slope at the start of a line at which its point counts as the top."""

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
    """Return the modes of the posteriors p(f | X, y), by Newton's method (R&W algorithm 3.1) with exact line search.

    The log posterior is concave and every step goes to about the top of a line that rises, so the method converges from
    any start, even if the plain iteration would oscillate (large amplitudes, duplicated points with opposite targets)
    or crawl (from 0, plain steps move the latent value of a certain example by about one each).

    Args:
        kernels: (K, n, n) kernel matrices.
        owners: (H,) the kernel of each problem.
        targets: (H, n) 1 for a positive, 0 for a negative example.
        start: (H, n) first guess of K^-1 f; 0 is taken where it is the better guess.

    Returns:
        (H, n) latent values f at the mode.

    Raises:
        ArithmeticError: no convergence, which only input that is not finite or not a covariance can cause.
    """
    modes = np.empty(targets.shape)
    if modes.size == 0:
        return modes
    n = targets.shape[1]
    # All curvatures are 1/4 where f = 0, so that all problems of a kernel which start there share their first factor.
    at_zero: dict[int, Array] = {}
    buffer = np.empty((n, n))
    for h, owner in enumerate(owners.tolist()):
        kernel = kernels[owner]
        alpha = start[h].copy()
        latent = kernel @ alpha
        if not (alpha.any() and _log_posterior(alpha, latent, targets[h]) > -n * np.log(2)):
            alpha[:] = latent[:] = 0.0
            if owner not in at_zero:
                at_zero[owner] = cholesky_factor(kernel, np.full(n, 0.5), np.empty((n, n)))
        modes[h] = _find_mode(kernel, targets[h], alpha, latent, at_zero.get(owner), buffer)
    return modes


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


def cholesky_factor(kernel: Array, root: Array, buffer: Array) -> Array:
    """Return the lower Cholesky factor of B = I + W^1/2 K W^1/2.

    Args:
        kernel: (n, n) K.
        root: (n,) diagonal of W^1/2.
        buffer: (n, n) takes the factor.

    Returns:
        (n, n) in column order, a view of the buffer.

    Raises:
        ArithmeticError: K is not a covariance.
    """
    np.multiply(kernel, root, out=buffer)
    buffer *= root[:, None]
    buffer.ravel()[:: len(buffer) + 1] += 1
    # LAPACK is called directly: the wrappers' checks cost more than the factorisation of a few dozen examples.
    factor, failed = dpotrf(buffer.T, lower=1, overwrite_a=1, clean=1)
    if failed:
        raise ArithmeticError('the kernel matrix is not a covariance')
    return np.asarray(factor)


def _find_mode(
    kernel: Array, targets: Array, alpha: Array, latent: Array, at_zero: Array | None, buffer: Array
) -> Array:
    """Return the (n,) mode of one problem.

    A factor serves as long as the steps are small: by then they shrink to a small share each time, and cost a hundredth
    of the factor.

    Args:
        kernel: (n, n) K.
        targets: (n,) 1 for a positive, 0 for a negative example.
        alpha: (n,) first guess of K^-1 f, overwritten.
        latent: (n,) first guess of f, overwritten.
        at_zero: factor of B where f = 0; needed if the first guess is 0.
        buffer: (n, n) for other factors.
    """
    root = np.full(len(targets), 0.5)
    factor, last = at_zero, np.inf if latent.any() else 0.0
    for _ in range(MAX_NEWTON_STEPS):
        p = expit(latent)
        if factor is None or not last <= STALE_STEP:
            root = np.sqrt(p * (1 - p))
            factor = cholesky_factor(kernel, root, buffer)
        gradient = targets - p - alpha
        solved, _ = dpotrs(factor, root * (kernel @ (targets - p) - latent), lower=1)
        # By Woodbury's identity K^-1 (K^-1 + W)^-1 = I - W^1/2 B^-1 W^1/2 K.
        alpha_step = gradient - root * solved
        latent_step = kernel @ alpha_step
        length = _step_length(latent, targets, alpha, alpha_step, latent_step)
        alpha += length * alpha_step
        latent += length * latent_step
        largest = float(np.abs(latent_step).max())
        if largest <= STEP_TOLERANCE:
            return latent
        last = length * largest
    raise ArithmeticError(f'no posterior mode after {MAX_NEWTON_STEPS} Newton steps')


def _step_length(latent: Array, targets: Array, alpha: Array, alpha_step: Array, latent_step: Array) -> float:
    """Return the length at which a step comes to about the top of its line.

    The log posterior is concave along the line, so its slope falls, and Newton's method in one dimension finds where it
    vanishes; a trial beyond the interval that must hold the top is replaced by its middle.
    """
    linear, quadratic = float(alpha @ latent_step), float(alpha_step @ latent_step)
    first = float((targets - expit(latent)) @ latent_step) - linear
    lower, upper, length = 0.0, np.inf, 1.0
    for _ in range(MAX_TRIALS):
        p = expit(latent + length * latent_step)
        slope = float((targets - p) @ latent_step) - linear - length * quadratic
        if abs(slope) <= FLAT_SHARE * first:
            return length
        lower, upper = (length, upper) if slope > 0 else (lower, length)
        length += slope / (float((p * (1 - p)) @ latent_step**2) + quadratic)
        if not lower < length < upper:
            length = (lower + upper) / 2
    return lower


def _log_posterior(alpha: Array, latent: Array, targets: Array) -> float:
    """Return log p(f | X, y) up to a constant (R&W equation 3.12)."""
    return float(-0.5 * alpha @ latent - np.logaddexp(0, (1 - 2 * targets) * latent).sum())


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


def slope_in_variance(variance: Array) -> Array:
    """Return (...) bounds of the derivative of the expected logistic function by the variance, over all means."""
    return VARIANCE_SLOPE[0] / (variance + VARIANCE_SLOPE[1])
