"""Binary classifiers that learn from the same examples, each by targets of its own, one example at a time if wanted."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from al_questioner.concepts.kernel_family import KernelFamily
from al_questioner.concepts.laplace.posterior import Marginals, Posterior, find_common_modes, laplace_posterior
from al_questioner.support.arrays import Array, Index

WARM_FIT_TOLERANCE = 1e-9
"""Distance from the mode, in posterior standard deviations, at which Newton's method takes over a warm fit."""


class BinaryClassifiers:
    """Gaussian process classifiers of n common examples; their input is checked by who uses them.

    Args:
        count: number of classifiers.
        kernels: their kernel for each number of features.

    Attributes:
        points: (n, m) features of the examples.
        groups: of the m features; None for one group of all.
        posterior: of all classifiers.
    """

    def __init__(self, count: int, kernels: KernelFamily) -> None:
        self.kernels = kernels
        self.points: Array = np.empty((0, 0))
        self.groups: tuple[str, ...] | None = None
        nothing = np.empty((count, 0))
        self.posterior: Posterior = laplace_posterior(np.empty((0, 0)), nothing, nothing)

    def fit(self, points: Array, targets: Array, groups: Sequence[str] | None = None) -> None:
        """Fit all classifiers, starting from the last fit as far as the examples continue its examples.

        Args:
            points: (n, m) features, which nobody changes from now on.
            targets: (count, n) 1 for a positive, 0 for a negative example.
            groups: m names; None for one group of all.
        """
        kept = None if groups is None else tuple(groups)
        has_same_groups, self.groups = kept == self.groups, kept
        before = self.posterior
        n_known = before.targets.shape[1]
        continues = np.array_equal(targets[:, :n_known], before.targets)
        has_one_more = len(points) == n_known + 1 and has_same_groups and np.array_equal(points[:-1], self.points)
        if continues and has_one_more:
            kernel, start = self._with_one_more(points[-1:], targets[:, -1:])
        else:
            kernel = self._covariance(points, points)
            gradient = np.zeros_like(targets)
            if continues:
                gradient[:, :n_known] = before.gradient
            start = find_common_modes(kernel, targets, gradient)
        self.posterior, self.points = laplace_posterior(kernel, targets, start), points

    def refitted(self, points: Array, groups: Sequence[str] | None = None) -> BinaryClassifiers:
        """Return classifiers of the same targets on (n, m') other features of the examples, and their groups."""
        others = BinaryClassifiers(len(self.posterior.targets), self.kernels)
        others.posterior = self.posterior
        others.fit(points, self.posterior.targets, groups)
        return others

    def at(self, points: Array) -> Marginals:
        """Return the beliefs at (k, m) points."""
        known = self.points if len(self.points) else np.empty((0, points.shape[1]))
        return self.posterior.at(self._covariance(known, points))

    def predict_each(
        self, points: Array, marginals: Marginals, rows: Index, tolerance: float | None
    ) -> tuple[Array, Array]:
        """Return the degrees at all of (k, m) points if one of e rows of them were one more example.

        Args:
            points: all of them.
            marginals: `at` these points.
            rows: (e,) the points that are hypothetical examples, each alone.
            tolerance: as of `look_ahead.predict_each`.

        Returns:
            Two tables, (count, e, k): if it were a negative example, and if it were a positive one.
        """
        # Imported here because it loads numba, which takes as long as all other imports of a process.
        from al_questioner.concepts.laplace.look_ahead import predict_each

        prior = self._covariance(points[rows], points)
        table = predict_each(self.posterior, marginals, rows, prior, self.kernels.amplitude, tolerance)
        return table[:, : len(rows)], table[:, len(rows) :]

    def _with_one_more(self, point: Array, targets: Array) -> tuple[Array, Array]:
        """Return kernel matrix and modes, (n + 1, n + 1) and (count, n + 1), after one more example.

        That has (1, m) features and (count, 1) targets, 1 where it is positive and 0 where it is negative.
        """
        from al_questioner.concepts.laplace.mode_shift import find_shift

        n, amplitude = len(self.points), self.kernels.amplitude
        kernel = np.empty((n + 1, n + 1))
        kernel[:n, :n] = self.posterior.kernel
        kernel[n, :n] = kernel[:n, n] = self._covariance(point, self.points)[0] if n else 0.0
        kernel[n, n] = amplitude
        marginals = self.posterior.at(kernel[:n, n:])
        shift = find_shift(
            self.posterior,
            marginals.solved.transpose(0, 2, 1),
            amplitude - marginals.explained,
            marginals.mean,
            targets,
            WARM_FIT_TOLERANCE,
        )
        modes = self.posterior.modes + shift.change[:, 0] / self.posterior.root
        start = np.concatenate([modes, shift.latent], axis=1)
        # If the search did not converge, start from 0.
        start[~(shift.error[:, 0] < 1)] = 0.0
        return kernel, start

    def _covariance(self, first: Array, second: Array) -> Array:
        return self.kernels.covariance(first, second, self.groups)
