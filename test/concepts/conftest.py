"""Oracles that share nothing with the package but the mathematics, and states to ask them about."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from scipy.special import expit
from sklearn.gaussian_process import GaussianProcessClassifier, kernels

from al_questioner.concepts import ConceptLearner, ConceptModels
from al_questioner.concepts.kernel import RBF, KernelShape, rbf_kernel
from al_questioner.concepts.laplace.gaussian_process import find_modes
from al_questioner.concepts.laplace.posterior import Marginals, Posterior, laplace_posterior
from al_questioner.domain import NO_SYMBOL, Scene
from al_questioner.support.arrays import Array
from shared.concept_learners import TOLD, learner, scene_of


@dataclass(frozen=True)
class LearningState:
    """Labels, and a scene to look ahead in."""

    features: Array
    labels: list[str]
    scene: Array
    symbols: tuple[str, ...]
    amplitude: float
    length_scale: float | None
    shape: KernelShape = RBF
    class_balance: float = 0.0

    @property
    def groups(self) -> list[str]:
        """A group of each feature: one of half of them, the rest in pairs."""
        count = self.features.shape[1]
        return [str(max(0, column - count // 2) // 2) for column in range(count)]

    def models(self) -> ConceptModels:
        return ConceptModels(
            self.symbols, self.amplitude, self.length_scale, shape=self.shape, class_balance=self.class_balance
        )

    def fitted(self) -> ConceptModels:
        return self.models().fit(self.features, self.labels, self.groups)

    def had_been_labelled(self, thing: int, symbol: str) -> tuple[Array, list[str]]:
        """Features and labels with one more."""
        return np.vstack([self.features, self.scene[thing]]), [*self.labels, symbol]

    def after(self, thing: int, symbol: str) -> Array:
        """Prediction for the scene by models that never looked ahead: fitted from nothing with one label more."""
        return self.models().fit(*self.had_been_labelled(thing, symbol), self.groups).predict_proba(self.scene)

    def largest_error(self, table: Array, pairs: list[tuple[int, int]] | None = None) -> float:
        """Of a look-ahead table, over some or all (thing, symbol); not a number if the table holds one."""
        n_things, n_symbols = len(self.scene), len(self.symbols)
        assert table.shape == (n_things, n_symbols, n_things, n_symbols)
        every = [(i, j) for i in range(n_things) for j in range(n_symbols)]
        return float(max(np.abs(table[i, j] - self.after(i, self.symbols[j])).max() for i, j in pairs or every))


@pytest.fixture
def learning_state() -> Callable[..., LearningState]:
    """A random state of learning, a function of the seed; everything else can be fixed."""

    def state(
        seed: int,
        n: int | None = None,
        amplitude: float | None = None,
        n_symbols: int | None = None,
        n_things: int | None = None,
        n_features: int | None = None,
        length_scale: float | None = None,
        duplicates: bool = False,
        one_class: bool = False,
        shape: KernelShape = RBF,
        class_balance: float = 0.0,
    ) -> LearningState:
        rng = np.random.default_rng(seed)

        def chosen(value: int | None, least: int, most: int) -> int:
            drawn = int(rng.integers(least, most + 1))
            return drawn if value is None else value

        n_labels, n_columns = chosen(n, 0, 40), chosen(n_features, 10, 70)
        n_objects, n_concepts = chosen(n_things, 1, 7), chosen(n_symbols, 1, 6)
        variance = float(rng.choice([1.0, 4.0, 25.0, 100.0])) if amplitude is None else amplitude
        symbols = tuple(f'symbol_{i}' for i in range(n_concepts))
        # As on a table: every symbol has its place, and things lie around it.
        places = 1.5 * rng.normal(size=(n_concepts + 1, n_columns))
        kinds = rng.integers(0, n_concepts + 1, size=n_labels + n_objects)
        points = places[kinds] + rng.normal(size=(len(kinds), n_columns))
        names = [*symbols, NO_SYMBOL]
        labels = [names[k] if rng.random() < 0.8 else names[rng.integers(len(names))] for k in kinds[:n_labels]]
        features, scene = points[:n_labels], points[n_labels:]
        if duplicates and n_labels:
            # Few views, named again and again and not always alike; the scene shows some of them.
            features = features[rng.integers(0, max(1, n_labels // 4), size=n_labels)]
            scene[: (n_objects + 1) // 2] = features[rng.integers(0, n_labels, size=(n_objects + 1) // 2)]
        if one_class:
            labels = [names[0]] * n_labels
        return LearningState(features, labels, scene, symbols, variance, length_scale, shape, class_balance)

    return state


@pytest.fixture
def sklearn_probability() -> Callable[..., Array | None]:
    """scikit-learn's answer, fitted again from its last mode until it stands still; None if it never does."""

    def probability(
        features: Array, targets: Array, test: Array, amplitude: float, length_scale: float
    ) -> Array | None:
        kernel = kernels.ConstantKernel(amplitude, 'fixed') * kernels.RBF(length_scale, 'fixed')
        classifier = GaussianProcessClassifier(kernel, optimizer=None).fit(features, targets)
        binary = classifier.base_estimator_
        binary.warm_start = True
        before = classifier.predict_proba(test)[:, 1]
        for _ in range(20):
            binary.fit(features, targets)
            after: Array = classifier.predict_proba(test)[:, 1]
            if np.abs(after - before).max() < 1e-10:
                return after
            before = after
        return None

    return probability


@dataclass(frozen=True)
class Problem:
    """Classifiers of common examples, and points to ask them about."""

    kernel: Array
    cross: Array
    among: Array
    targets: Array
    amplitude: float
    posterior: Posterior
    marginals: Marginals

    def mode(self, kernel: Array, targets: Array) -> Array:
        """(n,) mode of one classifier by the slow Newton."""
        return find_modes(kernel[None], np.zeros(1, dtype=np.intp), targets[None], np.zeros_like(targets)[None])[0]

    def with_one_more(self, point: int, target: float, symbol: int) -> tuple[Array, Array]:
        """Kernel matrix and targets once a point has become the last example of a classifier."""
        column = self.cross[:, [point]]
        kernel = np.block([[self.kernel, column], [column.T, self.among[[point]][:, [point]]]])
        return kernel, np.append(self.targets[symbol], target)

    def covariance(self, curvature: Array, kernel: Array | None = None) -> Array:
        """(K^-1 + W)^-1 without inverting K, in a form that shares nothing with the package: K (I + W K)^-1."""
        matrix = self.kernel if kernel is None else kernel
        return np.asarray(matrix @ np.linalg.inv(np.eye(len(matrix)) + curvature[:, None] * matrix))


@pytest.fixture
def problem() -> Callable[..., Problem]:
    """Random problems, a function of the seed."""

    def build(
        seed: int,
        n: int,
        amplitude: float,
        k: int = 4,
        n_symbols: int = 3,
        n_features: int = 3,
        duplicates: bool = False,
    ) -> Problem:
        rng = np.random.default_rng(seed)
        features, points = rng.normal(size=(n, n_features)), rng.normal(size=(k, n_features))
        if duplicates and n:
            features = features[rng.integers(0, max(1, n // 4), size=n)]
            points[0] = features[0]
        targets = rng.integers(0, 2, size=(n_symbols, n)).astype(np.float64)
        scale = np.sqrt(n_features)
        kernel, cross = rbf_kernel(features, features, amplitude, scale), rbf_kernel(features, points, amplitude, scale)
        posterior = laplace_posterior(kernel, targets, np.zeros_like(targets))
        among = amplitude * np.exp(-0.5 * cdist(points, points) ** 2 / scale**2)
        return Problem(kernel, cross, among, targets, amplitude, posterior, posterior.at(cross))

    return build


@pytest.fixture
def curvature() -> Callable[[Array], Array]:
    """W of latent values, from both tails of the logistic function: p (1 - p) alone loses the upper one."""
    return lambda latent: expit(latent) * expit(-latent)


@pytest.fixture
def scene() -> Scene:
    """Six objects."""
    return scene_of(np.random.default_rng(0).normal(loc=5, scale=3, size=(6, 4)))


@pytest.fixture
def taught(scene: Scene) -> ConceptLearner:
    """A learner that was told what three of them are."""
    return learner(scene, labels=TOLD)
