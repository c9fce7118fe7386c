"""The kernel that learners of earlier versions found by marginal likelihood, where their user wanted it.

Learners do so no more (docs/results/hyperparameters.md), but a session log tells only when it was done and not what was
found: without this such a log could be neither checked nor gone on with. Equations and algorithms are those of
Rasmussen and Williams, Gaussian Processes for Machine Learning (2006) (below: R&W).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from al_questioner.concepts.kernel import Kernel
from al_questioner.concepts.kernel_family import KernelFamily
from al_questioner.concepts.laplace.gaussian_process import expit, find_modes, well_conditioned
from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

cdist = late('scipy.spatial.distance', 'cdist')
minimize = late('scipy.optimize', 'minimize')

AMPLITUDE_FACTOR = 4.0
LENGTH_SCALE_FACTOR = 2.0
"""Largest factor, up or down, between a tuned value and the configured one."""

PRIOR_DEVIATIONS = np.array([1.0, 0.25])
"""Standard deviations of log amplitude and log length scale in the normal prior around the configured kernel."""


def log_marginal_likelihood(squared_distances: Array, targets: Array, kernel: Kernel) -> tuple[float, Array]:
    """Return Laplace's approximation of log p(y | X, kernel), summed over the classifiers, and its gradient.

    The value is R&W equation 3.32, the gradient algorithm 5.1 for the logistic likelihood.
    Everything is solved through B = I + W^1/2 K W^1/2, so that duplicated points cause no error.

    Args:
        squared_distances: (n, n) between the training points.
        targets: (H, n) 1 for a positive, 0 for a negative example of each of H classifiers.
        kernel: the kernel at which to evaluate.

    Returns:
        The value, and (2,) its derivatives by log amplitude and by log length scale.
    """
    exponent = squared_distances / kernel.length_scale**2
    covariance = kernel.amplitude * np.exp(-0.5 * exponent)
    owners = np.zeros(len(targets), dtype=np.intp)
    modes = find_modes(covariance[None], owners, targets, start=np.zeros_like(targets))
    probability = expit(modes)
    slope = targets - probability  # of the log likelihood, and K^-1 f at the mode (R&W equation 3.17)
    curvature = probability * (1 - probability)
    root = np.sqrt(curvature)
    b = well_conditioned(covariance, root)
    log_likelihood = -np.logaddexp(0, (1 - 2 * targets) * modes).sum()
    half_log_determinant = 0.5 * np.linalg.slogdet(b)[1].sum()
    value = float(-0.5 * (slope * modes).sum() + log_likelihood - half_log_determinant)

    r = root[:, :, None] * np.linalg.inv(b) * root[:, None, :]
    r_covariance = r @ covariance
    variance = kernel.amplitude - np.einsum('ij,hji->hi', covariance, r_covariance)
    # Equation 5.23: the mode moves with the kernel, and W, whose derivative this holds, with the mode.
    by_mode = -0.5 * variance * curvature * (1 - 2 * probability)
    gradient = np.empty(2)
    for row, derivative in enumerate((covariance, covariance * exponent)):
        explicit = 0.5 * np.einsum('hi,ij,hj->', slope, derivative, slope) - 0.5 * (r * derivative).sum()
        force = slope @ derivative
        moved = force - np.einsum('ij,hj->hi', covariance, np.einsum('hij,hj->hi', r, force))
        gradient[row] = explicit + (by_mode * moved).sum()
    return value, gradient


def tuned_kernel(points: Array, targets: Array, configured: Kernel) -> Kernel:
    """Return the kernel of largest marginal likelihood times prior, within bounds around the configured one.

    It depends on the examples only: the search starts at the configured kernel, not at the last result. It finds the
    optimum that L-BFGS-B reaches from there.

    Args:
        points: (n, m) training points; without any, the configured kernel is returned.
        targets: (H, n) 1 for a positive, 0 for a negative example of each of H classifiers.
        configured: centre of the prior and of the bounds, `AMPLITUDE_FACTOR` and `LENGTH_SCALE_FACTOR`.
    """
    if len(points) == 0:
        return configured
    squared_distances = cdist(points, points, 'sqeuclidean')
    centre = np.log([configured.amplitude, configured.length_scale])
    reach = np.log([AMPLITUDE_FACTOR, LENGTH_SCALE_FACTOR])

    def loss(step: Array) -> tuple[float, Array]:
        value, gradient = log_marginal_likelihood(squared_distances, targets, _kernel(centre + step))
        return 0.5 * float(((step / PRIOR_DEVIATIONS) ** 2).sum()) - value, step / PRIOR_DEVIATIONS**2 - gradient

    found = minimize(loss, np.zeros(2), jac=True, method='L-BFGS-B', bounds=np.column_stack([-reach, reach]))
    return _kernel(centre + found.x)


def tuned_kernels(points: Array, targets: Array, configured: KernelFamily) -> KernelFamily:
    """Return the kernels of which that for (n, m) points is the `tuned_kernel`.

    Their length scale is a multiple of the root of the number of features, even if the configured one is not.
    """
    n_features = points.shape[1]
    found = tuned_kernel(points, targets, configured.kernel_of(n_features))
    relative = found.length_scale / float(np.sqrt(n_features))
    return replace(configured, amplitude=found.amplitude, length_scale=None, relative_length_scale=relative)


def _kernel(logarithms: Array) -> Kernel:
    amplitude, length_scale = np.exp(logarithms)
    return Kernel(float(amplitude), float(length_scale))
