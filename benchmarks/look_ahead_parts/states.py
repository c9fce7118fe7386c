"""States of a learner, its labelled features and scene, drawn at random."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import ConceptModels
from al_questioner.domain import NO_SYMBOL
from al_questioner.support.arrays import Array

AMPLITUDE = 4.0
"""Variance of the kernel that the learner uses."""

SPREAD = 1.5
"""Distance of a cluster's centre from the middle, in standard deviations of its members, in each feature."""


@dataclass(frozen=True, eq=False)
class State:
    """A learner's examples and the scene before it.

    Attributes:
        symbols: |Y| names.
        features: (n, m) of the labelled things.
        labels: n names, each a symbol or `NO_SYMBOL`.
        scene: (|X|, m) features.
        amplitude: variance of the kernel.
    """

    symbols: tuple[str, ...]
    features: Array
    labels: list[str]
    scene: Array
    amplitude: float = AMPLITUDE

    @property
    def length_scale(self) -> float:
        """Length scale that `ConceptModels` takes when none is given."""
        return float(np.sqrt(self.scene.shape[1]))

    @property
    def positives(self) -> NDArray[np.intp]:
        """(|Y|,) numbers of positive examples."""
        return np.array([self.labels.count(symbol) for symbol in self.symbols], dtype=np.intp)

    def models(self) -> ConceptModels:
        """New models that know the examples."""
        return ConceptModels(self.symbols, self.amplitude).fit(self.features, self.labels)

    def targets(self, symbol: int) -> NDArray[np.intp]:
        """(n,) 1 where an example is a positive one of a symbol, else 0."""
        return np.array([label == self.symbols[symbol] for label in self.labels], dtype=np.intp)


def names(number: int) -> tuple[str, ...]:
    """Return the names of this number of symbols, in alphabetical order."""
    return tuple(f'symbol_{i:02}' for i in range(number))


def clustered_state(rng: np.random.Generator, n: int, things: int, symbols: int, m: int = 60) -> State:
    """Gaussian clusters, one a symbol, standardised; every symbol has an example once n reaches their number."""
    classes, kinds = np.arange(n) % symbols, rng.integers(symbols, size=things)
    known, scene = _standardised(*_clusters(rng, m, symbols, SPREAD / np.sqrt(2), classes, kinds))
    return State(names(symbols), known, [names(symbols)[c] for c in classes], scene)


def random_state(rng: np.random.Generator, amplitude: float | None = None) -> State:
    """A state of any kind that a learner may meet, and of some that it hopefully does not.

    It has 0 to 150 examples, 10 to 70 features, 2 to 12 things and 2 to 5 symbols, and clusters that lie together or
    far apart. In one of three states examples repeat under labels of their own and the scene shows some of them again;
    one of ten has examples of a single class, one of thirty none at all. Without an amplitude, it is any from 1 to 100,
    their logarithm uniform.
    """
    n = 0 if rng.random() < 1 / 30 else int(rng.integers(151))
    m, things, symbols = int(rng.integers(10, 71)), int(rng.integers(2, 13)), int(rng.integers(2, 6))
    drawn = float(np.exp(rng.uniform(0, np.log(100))))
    classes, kinds = rng.integers(symbols + 1, size=n), rng.integers(symbols + 1, size=things)
    if rng.random() < 0.1:
        classes[:] = rng.integers(symbols + 1)
    known, scene = _clusters(rng, m, symbols + 1, rng.uniform(0, 2), classes, kinds)
    if n and rng.random() < 1 / 3:
        again = rng.random(n) < rng.uniform(0, 1)
        known[again] = known[rng.integers(n, size=int(again.sum()))]
        seen = rng.random(things) < 0.5
        scene[seen] = known[rng.integers(n, size=int(seen.sum()))]
    known, scene = _standardised(known, scene)
    every = (*names(symbols), NO_SYMBOL)
    return State(names(symbols), known, [every[c] for c in classes], scene, drawn if amplitude is None else amplitude)


def _clusters(
    rng: np.random.Generator, m: int, number: int, spread: float, *classes: NDArray[np.intp]
) -> tuple[Array, ...]:
    """(len, m) features of things of each sequence of classes, whose centres are `spread` from the middle."""
    centres = spread * rng.normal(size=(number, m))
    return tuple(centres[of] + rng.normal(size=(len(of), m)) for of in classes)


def _standardised(known: Array, scene: Array) -> tuple[Array, Array]:
    """Both in units of the standard deviations of all, from their mean."""
    every = np.concatenate([known, scene])
    mean, deviation = every.mean(axis=0), every.std(axis=0)
    # Duplicates must stay equal and a feature that never varies must not blow up.
    deviation[deviation < 1e-9] = 1.0
    return (known - mean) / deviation, (scene - mean) / deviation
