"""A kernel for each number of features: the more there are, the farther apart views lie, and the farther it reaches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.concepts.kernel import RBF, Kernel, KernelShape, rbf_kernel, saturating_kernel
from al_questioner.domain import InputError
from al_questioner.support.arrays import Array


@dataclass(frozen=True)
class KernelFamily:
    """Kernels of one amplitude and shape, one for each number of features.

    Attributes:
        amplitude: variance of the process.
        length_scale: length scale for any number of features, in their unit; None for a multiple of the root of it.
        relative_length_scale: this multiple.
        shape: how the kernels treat groups of features and single large differences.

    Raises:
        InputError: an amplitude or length scale that is not a number above 0.
    """

    amplitude: float
    length_scale: float | None = None
    relative_length_scale: float = 1.0
    shape: KernelShape = RBF

    def __post_init__(self) -> None:
        for name in ('amplitude', 'length_scale', 'relative_length_scale'):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0):
                raise InputError(f'{name} must be a number above 0, not {value}')

    def kernel_of(self, n_features: int) -> Kernel:
        """Return size and reach of the kernel for this number of features."""
        if self.length_scale is not None:
            return Kernel(self.amplitude, self.length_scale)
        return Kernel(self.amplitude, self.relative_length_scale * float(np.sqrt(max(n_features, 1))))

    def covariance(self, first: Array, second: Array, groups: Sequence[str] | None) -> Array:
        """Return the (n, k) covariances of (n, m) points and (k, m) others.

        The groups are those of the m features; None for one group of all.
        """
        n_features = second.shape[1]
        length_scale = self.kernel_of(n_features).length_scale
        if self.shape == RBF:
            return rbf_kernel(first, second, self.amplitude, length_scale)
        relative = length_scale / np.sqrt(max(n_features, 1))
        shares = self.shape.shares(groups or ('',) * n_features)
        return saturating_kernel(first, second, self.amplitude, relative, shares, self.shape.saturation)
