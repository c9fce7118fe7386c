"""Other ways to the look-ahead's table: all refit classifiers, once for every hypothesis."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from look_ahead_parts.states import State
from numpy.typing import NDArray
from sklearn.gaussian_process import GaussianProcessClassifier
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, Kernel, NormalizedKernelMixin, StationaryKernelMixin

from al_questioner.concepts import ConceptModels
from al_questioner.concepts.kernel import RBF as OWN_RBF
from al_questioner.concepts.kernel import saturating_kernel
from al_questioner.domain import NO_SYMBOL
from al_questioner.support.arrays import Array

MOST_REFITS = 20
STANDS_STILL = 1e-10
"""Largest change of a probability by one more fit at which scikit-learn is taken to have converged."""


class GroupedKernel(StationaryKernelMixin, NormalizedKernelMixin, Kernel):  # type: ignore[misc]
    """The kernel of groups for scikit-learn: the same code as ours, so that only the look-aheads differ.

    Args:
        amplitude: variance of the process.
        saturation: of single features.
        shares: (m,) of the features.
    """

    def __init__(self, amplitude: float, saturation: float, shares: Array) -> None:
        self.amplitude, self.saturation, self.shares = amplitude, saturation, shares

    def __call__(self, first: Array, second: Array | None = None, eval_gradient: bool = False) -> Array:
        """Return the covariance of every pair of rows; there are no hyperparameters, and so no gradient."""
        other = first if second is None else second
        return saturating_kernel(first, other, self.amplitude, 1.0, self.shares, self.saturation)

    def diag(self, points: Array) -> Array:
        """Return the variance of each row."""
        return np.full(len(points), self.amplitude)


def as_users_write(state: State, kernel: Any = None) -> Array:
    """The table by scikit-learn, a multiclass classifier for each thing and symbol, with the state's kernel or another.

    Returns:
        (|X|, |Y|, |X|, |Y|), which scikit-learn normalises over the symbols, without class balance.
    """
    kernel = kernel_of(state) if kernel is None else kernel
    things, symbols = len(state.scene), len(state.symbols)
    table = np.empty((things, symbols, things, symbols))
    for i, thing in enumerate(state.scene):
        for j, symbol in enumerate(state.symbols):
            classifier = GaussianProcessClassifier(kernel, optimizer=None)
            classifier.fit(np.vstack([state.features, thing]), [*state.labels, symbol])
            table[i, j] = classifier.predict_proba(state.scene)
    return table


def distinct_fits(state: State) -> Array:
    """The table by scikit-learn, a binary classifier for each thing and symbol and whether the one is the other.

    There is no class balance in it.
    """
    return assembled(state, lambda i, j, target: _binary(state, i, j, target).predict_proba(state.scene)[:, 1])


def until_convergence(state: State) -> Array:
    """`distinct_fits`, each fitted again from its last mode until it stands still; NaN where it never does."""
    return assembled(state, lambda i, j, target: converged(state, i, j, target))


def own_refits(state: State) -> Array:
    """The table by fresh `ConceptModels` with the one example more; a model of one symbol for each distinct fit."""

    def probabilities(i: int, j: int, target: int) -> Array:
        labels = ['is' if label == state.symbols[j] else NO_SYMBOL for label in state.labels]
        models = ConceptModels(('is',), state.kind.amplitude, shape=state.kind.shape)
        named = [*labels, 'is' if target else NO_SYMBOL]
        models.fit(np.vstack([state.features, state.scene[i]]), named, state.groups)
        return models.predict_proba(state.scene)[:, 0]

    return state.balanced(assembled(state, probabilities))


def own_refit(state: State, thing: int, symbol: int) -> Array:
    """(|X|, |Y|) one entry of the table, by fresh `ConceptModels` of all symbols."""
    models, labels = state.empty_models(), [*state.labels, state.symbols[symbol]]
    models.fit(np.vstack([state.features, state.scene[thing]]), labels, state.groups)
    return models.predict_proba(state.scene)


def assembled(state: State, probabilities: Callable[[int, int, int], Array]) -> Array:
    """(|X|, |Y|, |X|, |Y|) from what each symbol's classifier says if a thing is, or is not, an example of it.

    The function goes from a thing, a symbol and 1 or 0 to (|X|,) probabilities.
    """
    things, symbols = len(state.scene), len(state.symbols)
    table = np.empty((things, symbols, things, symbols))
    for i, j in np.ndindex(things, symbols):
        table[i, :, :, j] = probabilities(i, j, 0)
        table[i, j, :, j] = probabilities(i, j, 1)
    return table


def converged(state: State, thing: int, symbol: int, target: int) -> Array:
    """(|X|,) scikit-learn's probabilities of one symbol, refitted until they stand still; NaN if they never do."""
    classifier = _binary(state, thing, symbol, target)
    features, targets = _with_one_more(state, thing, symbol, target)
    binary = classifier.base_estimator_
    binary.warm_start = True
    before: Array = classifier.predict_proba(state.scene)[:, 1]
    for _ in range(MOST_REFITS):
        binary.fit(features, targets)
        after: Array = classifier.predict_proba(state.scene)[:, 1]
        if np.abs(after - before).max() < STANDS_STILL:
            return after
        before = after
    return np.full(len(state.scene), np.nan)


def kernel_of(state: State) -> Any:
    """The kernel of the state's classifiers for scikit-learn, with hyperparameters that stay as they are."""
    kind = state.kind
    if kind.shape == OWN_RBF:
        return own_rbf_of(state)
    return GroupedKernel(kind.amplitude, kind.shape.saturation, kind.shape.shares(state.groups))


def own_rbf_of(state: State) -> Any:
    """scikit-learn's own RBF kernel, of the same amplitude."""
    return ConstantKernel(state.kind.amplitude, 'fixed') * RBF(state.length_scale, 'fixed')


def _binary(state: State, thing: int, symbol: int, target: int) -> GaussianProcessClassifier:
    """One classifier of one symbol, fitted."""
    classifier = GaussianProcessClassifier(kernel_of(state), optimizer=None)
    return classifier.fit(*_with_one_more(state, thing, symbol, target))


def _with_one_more(state: State, thing: int, symbol: int, target: int) -> tuple[Array, NDArray[np.intp]]:
    """Features and targets of the examples and of a thing that is, or is not, one of a symbol."""
    return np.vstack([state.features, state.scene[thing]]), np.append(state.targets(symbol), target)


class WithSampleWeight(GaussianProcessClassifier):  # type: ignore[misc]
    """scikit-learn's classifier as scikit-activeml calls it: with weights, which are None."""

    def fit(self, X: Array, y: NDArray[np.intp], sample_weight: None = None) -> WithSampleWeight:  # noqa: N803
        """Fit, without weights; scikit-activeml looks the names of the arguments up."""
        super().fit(X, y)
        return self


def expected_error_reduction(state: State) -> Callable[[], Any] | None:
    """A call of scikit-activeml that weighs asking for the label of each thing; None if it is not installed."""
    try:
        from skactiveml.classifier import SklearnClassifier
        from skactiveml.pool import MonteCarloEER
    except ImportError:
        return None
    symbols = np.arange(len(state.symbols))
    known = [state.symbols.index(label) for label in state.labels]
    features = np.vstack([state.features, state.scene])
    labels = np.append(known, np.full(len(state.scene), np.nan))
    classifier = SklearnClassifier(WithSampleWeight(kernel_of(state), optimizer=None), classes=symbols)
    strategy = MonteCarloEER(random_state=0)
    return lambda: strategy.query(features, labels, classifier, X_eval=state.scene, return_utilities=True)
