"""Laplace posteriors of classifiers that share their examples, and their predictions at points.

In the symbols of docs/explanation/look_ahead.md: K is the kernel matrix of the n examples, f the mode, p = logistic(f),
t the targets, r = t - p the gradient of the log likelihood, W = diag(p (1 - p)), B = I + W^1/2 K W^1/2. At the mode
f = K r.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from al_questioner.concepts.laplace.gaussian_process import cholesky_factor, expit, find_modes
from al_questioner.support.arrays import Array, Index
from al_questioner.support.late_imports import late

dpotri = late('scipy.linalg.lapack', 'dpotri')

NEWTON_TOLERANCE = 1e-7
"""Largest Newton step from a point that is accepted as the mode; W is that of the point before the step."""

SMALLEST_ROOT = 1e-6
"""Lower limit of W^1/2: an example this certain changes no variance, and the inverse stays finite."""


@dataclass(frozen=True, eq=False)
class Posterior:
    """Posterior of |Y| classifiers on n common examples, at their modes.

    Attributes:
        kernel: (n, n) K.
        targets: (|Y|, n) 1 for a positive, 0 for a negative example.
        modes: (|Y|, n) f.
        root: (|Y|, n) diagonal of W^1/2.
        covariance: (|Y|, n, n) T = W^1/2 C W^1/2, with C = (K^-1 + W)^-1 the posterior covariance of the examples. It
            is I - B^-1, which lies between 0 and I for any data.
    """

    kernel: Array
    targets: Array
    modes: Array
    root: Array
    covariance: Array

    @property
    def gradient(self) -> Array:
        """Gradient r = t - p, (|Y|, n)."""
        gradient: Array = self.targets - expit(self.modes)
        return gradient

    def at(self, cross: Array) -> Marginals:
        """Return the beliefs of the classifiers at k points.

        Args:
            cross: (n, k) covariances of the examples with the points.
        """
        scaled = self.root[:, :, None] * cross
        return Marginals(cross, np.matmul(self.gradient, cross), scaled, scaled - np.matmul(self.covariance, scaled))


@dataclass(frozen=True, eq=False)
class Marginals:
    """Beliefs at k points.

    Attributes:
        cross: (n, k) prior covariances of the examples with the points.
        mean: (|Y|, k) posterior mean of the latent value (R&W equation 3.21).
        scaled: (|Y|, n, k) W^1/2 times `cross`.
        solved: (|Y|, n, k) B^-1 W^1/2 times `cross`, which is W^1/2 times the posterior covariance of the
            examples with the points.
    """

    cross: Array
    mean: Array
    scaled: Array
    solved: Array

    @property
    def explained(self) -> Array:
        """Decrease of the variance by the examples (R&W equation 3.24), (|Y|, k)."""
        explained: Array = np.einsum('ynk,ynk->yk', self.scaled, self.solved)
        return explained

    def covariance(self, points: Index, prior: Array) -> Array:
        """Return the posterior covariance of some of the points with all of them.

        Args:
            points: (e,) indices of the points.
            prior: (e, k) their prior covariance.

        Returns:
            (|Y|, e, k).
        """
        covariance: Array = prior - np.matmul(self.scaled[:, :, points].transpose(0, 2, 1), self.solved)
        return covariance


def laplace_posterior(kernel: Array, targets: Array, start: Array) -> Posterior:
    """Return the posteriors of |Y| classifiers.

    Args:
        kernel: (n, n) K.
        targets: (|Y|, n) 1 for a positive, 0 for a negative example.
        start: (|Y|, n) f, known or guessed; the mode is searched for if it is not there.

    Raises:
        ArithmeticError: no convergence, which only input that is not finite or not a covariance can cause.
    """
    posterior, step = _posterior_and_step(kernel, targets, start)
    if not np.abs(step).max(initial=0.0) <= NEWTON_TOLERANCE:
        modes = find_common_modes(kernel, targets, posterior.gradient)
        posterior, step = _posterior_and_step(kernel, targets, modes)
    return replace(posterior, modes=posterior.modes + step)


def find_common_modes(kernel: Array, targets: Array, start: Array) -> Array:
    """Return the (|Y|, n) modes of classifiers that share their examples, see `find_modes`.

    Args:
        kernel: (n, n) K.
        targets: (|Y|, n) 1 for a positive, 0 for a negative example.
        start: (|Y|, n) first guess of r, which is K^-1 f at the mode.

    Raises:
        ArithmeticError: no convergence, which only input that is not finite or not a covariance can cause.
    """
    owners: Index = np.zeros(len(targets), dtype=np.intp)
    return find_modes(kernel[None], owners, targets, start)


def _posterior_and_step(kernel: Array, targets: Array, modes: Array) -> tuple[Posterior, Array]:
    """Return the posterior as if the modes were right, and (|Y|, n) Newton's step (I + K W)^-1 (K r - f)."""
    p = expit(modes)
    root = np.maximum(np.sqrt(p * (1 - p)), SMALLEST_ROOT)
    covariance = np.empty((*root.shape, root.shape[1]))
    buffer = np.empty(covariance.shape[1:])
    for k in range(len(root)):
        _write_covariance(kernel, root[k], buffer, covariance[k])
    residual = root * (np.matmul(targets - p, kernel) - modes)
    step: Array = (residual - np.matmul(covariance, residual[:, :, None])[:, :, 0]) / root
    return Posterior(kernel, targets, modes, root, covariance), step


def _write_covariance(kernel: Array, root: Array, buffer: Array, covariance: Array) -> None:
    """Write T = I - B^-1, by way of a buffer; all are (n, n) but for the root, (n,)."""
    if len(root) == 0:
        return
    lower, _ = dpotri(cholesky_factor(kernel, root, buffer), lower=1, overwrite_c=1)
    np.add(lower, lower.T, out=covariance)
    np.negative(covariance, out=covariance)
    diagonal = np.arange(len(root))
    covariance[diagonal, diagonal] = 1 - lower[diagonal, diagonal]
