"""Directions of the weights about which the demonstrations tell something."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from al_questioner.imitation.demonstration import Demonstration, all_steps, feature_scale
from al_questioner.support.arrays import Array

NEGLIGIBLE = 1e-5
"""Singular value of the differences, relative to the largest, below which a direction of the weights is free."""


@dataclass(frozen=True, eq=False)
class Identifiability:
    """The directions of the weights that no choice of the demonstrations depends on.

    Attributes:
        scale: (F,) of the features, see `feature_scale`.
        null_space: (k, F) orthonormal rows, in units of the features' scale: w may move along them unseen.
        unidentified: names of the features that some such direction involves, in canonical order.
        cancelling: those of them that are the same for all candidates of every step.
    """

    scale: Array
    null_space: Array
    unidentified: tuple[str, ...]
    cancelling: tuple[str, ...]

    def describe(self) -> str:
        """One sentence for people."""
        if not self.unidentified:
            return 'every weight is identified by the demonstrations'
        parts = []
        if self.cancelling:
            names = ', '.join(self.cancelling)
            parts.append(f'{names}: the same for all candidates of every turn, so the weight is 0')
        linked = ', '.join(name for name in self.unidentified if name not in self.cancelling)
        if linked:
            parts.append(f'{linked}: they vary only together, the prior divides the weight among them')
        return f'not identified: {"; ".join(parts)}'

    def project(self, weights: Array) -> Array:
        """Return the weights, (F,) in the unit of the features, without what cannot be identified."""
        scaled = weights * self.scale
        identified = scaled - self.null_space.T @ (self.null_space @ scaled)
        return np.divide(identified, self.scale, out=np.zeros_like(weights), where=self.scale > 0)


def identify(demonstrations: Sequence[Demonstration]) -> Identifiability:
    """Find the directions along which the weights could change without changing any choice probability.

    p(a|s, w) depends on w through w . (phi(a) - phi(b)) alone: what the stacked differences map to zero is free.
    """
    scale, names = feature_scale(demonstrations), demonstrations[0].feature_set.names
    differences = np.concatenate([step.features - step.features.mean(axis=0) for step in all_steps(demonstrations)])
    scaled = np.divide(differences, scale, out=np.zeros_like(differences), where=scale > 0)
    squared, directions = np.linalg.eigh(scaled.T @ scaled)
    null_space = directions.T[squared <= NEGLIGIBLE**2 * max(squared.max(), 1.0)]
    involved = np.abs(null_space).max(axis=0, initial=0.0) > np.sqrt(NEGLIGIBLE)
    return Identifiability(
        scale,
        null_space,
        tuple(name for name, free in zip(names, involved, strict=True) if free),
        tuple(name for name, size in zip(names, scale, strict=True) if size == 0),
    )
