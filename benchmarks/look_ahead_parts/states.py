"""States of a learner, its labelled features and scene, drawn at random."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import ConceptModels
from al_questioner.concepts.kernel import GROUPED, KERNEL_SHAPES, RBF, KernelShape
from al_questioner.domain import NO_SYMBOL
from al_questioner.domain.settings import DEFAULT_CLASSIFIERS
from al_questioner.support.arrays import Array

SPREAD = 1.5
"""Distance of a cluster's centre from the middle, in standard deviations of its members, in each feature."""

GROUP_SIZES = (11, 4, 7, 4, 1, 1)
"""Sizes of the groups of features, again and again: colour, size, shape and texture of a view, and two sensors."""

LARGEST_AMPLITUDE = 300.0


@dataclass(frozen=True)
class Kind:
    """Settings of the classifiers.

    Attributes:
        amplitude: variance of the kernel.
        shape: of the kernel.
        class_balance: how much of the effect of the counts of examples is taken from the degrees.
    """

    amplitude: float
    shape: KernelShape = RBF
    class_balance: float = 0.0

    def __str__(self) -> str:
        shape = 'rbf' if self.shape == RBF else 'grouped'
        return f'{shape} kernel, amplitude {self.amplitude:g}, class balance {self.class_balance:g}'


SHIPPED = Kind(
    DEFAULT_CLASSIFIERS.amplitude, KERNEL_SHAPES[DEFAULT_CLASSIFIERS.kernel_shape], DEFAULT_CLASSIFIERS.class_balance
)
"""Settings of a learner that is told nothing else."""

SHIPPED_RBF = Kind(DEFAULT_CLASSIFIERS.amplitude)
"""The same amplitude with the kernel that scikit-learn has, too."""

SMALL_RBF = Kind(4.0)
"""Settings of `ConceptModels` that are told nothing else."""


@dataclass(frozen=True, eq=False)
class State:
    """A learner's examples and the scene before it.

    Attributes:
        symbols: |Y| names.
        features: (n, m) of the labelled things.
        labels: n names, each a symbol or `NO_SYMBOL`.
        scene: (|X|, m) features.
        groups: m names, the group of each feature.
        kind: of classifiers.
    """

    symbols: tuple[str, ...]
    features: Array
    labels: list[str]
    scene: Array
    groups: tuple[str, ...]
    kind: Kind = SHIPPED

    @property
    def length_scale(self) -> float:
        """Length scale that `ConceptModels` takes when none is given."""
        return float(np.sqrt(self.scene.shape[1]))

    @property
    def positives(self) -> NDArray[np.intp]:
        """(|Y|,) numbers of positive examples."""
        return np.array([self.labels.count(symbol) for symbol in self.symbols], dtype=np.intp)

    def empty_models(self) -> ConceptModels:
        """New models without examples."""
        kind = self.kind
        return ConceptModels(self.symbols, kind.amplitude, shape=kind.shape, class_balance=kind.class_balance)

    def models(self) -> ConceptModels:
        """New models that know the examples."""
        return self.empty_models().fit(self.features, self.labels, self.groups)

    def odds(self) -> Array:
        """(|Y|, |Y|) odds of each symbol that class balance takes away if [i] were the next label."""
        counts = self.positives + np.eye(len(self.symbols)) + 0.5
        odds: Array = (counts / np.exp(np.log(counts).mean(axis=1, keepdims=True))) ** self.kind.class_balance
        return odds

    def balanced(self, degrees: Array) -> Array:
        """Degrees (|X|, |Y|, |X|, |Y|) of a look-ahead without class balance as they are with it."""
        return without_odds(degrees, self.odds()[:, None])

    def targets(self, symbol: int) -> NDArray[np.intp]:
        """(n,) 1 where an example is a positive one of a symbol, else 0."""
        return np.array([label == self.symbols[symbol] for label in self.labels], dtype=np.intp)


def without_odds(degrees: Array, odds: Array) -> Array:
    """Degrees whose odds are so many times smaller."""
    smaller: Array = degrees / (degrees + (1 - degrees) * odds)
    return smaller


def names(number: int) -> tuple[str, ...]:
    """Return the names of this number of symbols, in alphabetical order."""
    return tuple(f'symbol_{i:02}' for i in range(number))


def group_names(m: int, sizes: tuple[int, ...] = GROUP_SIZES) -> tuple[str, ...]:
    """Return the (m,) groups of features, of these sizes again and again."""
    each = (str(number) for number, size in enumerate(itertools.cycle(sizes)) for _ in range(size))
    return tuple(itertools.islice(each, m))


def clustered_state(
    rng: np.random.Generator, n: int, things: int, symbols: int, m: int = 60, kind: Kind = SHIPPED
) -> State:
    """Gaussian clusters, one a symbol, standardised; every symbol has an example once n reaches their number."""
    classes, kinds = np.arange(n) % symbols, rng.integers(symbols, size=things)
    known, scene = _standardised(*_clusters(rng, m, symbols, SPREAD / np.sqrt(2), classes, kinds))
    return State(names(symbols), known, [names(symbols)[c] for c in classes], scene, group_names(m), kind)


def random_state(rng: np.random.Generator, kind: Kind | None = None) -> State:
    """A state of any kind that a learner may meet, and of some that it hopefully does not.

    It has 0 to 150 examples, 10 to 70 features, 2 to 12 things and 2 to 5 symbols, and clusters that lie together or
    far apart. In one of three states examples repeat under labels of their own and the scene shows some of them again;
    one of ten has examples of a single class, one of thirty none at all. Without a kind of classifiers, their amplitude
    is any from 1 to 300, its logarithm uniform; half of them have the RBF kernel, half one of groups of random sizes,
    saturation and exponent, among these the one that ships; and half balance the classes.
    """
    n = 0 if rng.random() < 1 / 30 else int(rng.integers(151))
    m, things, symbols = int(rng.integers(10, 71)), int(rng.integers(2, 13)), int(rng.integers(2, 6))
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
    groups = group_names(m, tuple(int(size) for size in rng.integers(1, 13, size=m)))
    drawn = random_kind(rng)
    return State(names(symbols), known, [every[c] for c in classes], scene, groups, kind or drawn)


def random_kind(rng: np.random.Generator) -> Kind:
    """Classifiers of any settings, see `random_state`."""
    amplitude = float(np.exp(rng.uniform(0, np.log(LARGEST_AMPLITUDE))))
    shapes = (RBF, RBF, GROUPED, KernelShape(float(rng.uniform(1, 4)), float(rng.uniform(0, 1))))
    return Kind(amplitude, shapes[int(rng.integers(4))], 0.5 * float(rng.integers(2)))


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
