"""One binary Gaussian process classifier per symbol, and their predictions after one more label."""

from __future__ import annotations

import itertools
import logging
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from al_questioner.concepts.class_balance import balance_degrees, largest_slope
from al_questioner.concepts.kernel import RBF, KernelShape
from al_questioner.concepts.kernel_family import KernelFamily
from al_questioner.concepts.laplace.classifiers import BinaryClassifiers
from al_questioner.concepts.laplace.gaussian_process import expected_logistic
from al_questioner.concepts.laplace.posterior import Marginals
from al_questioner.domain import NO_SYMBOL, InputError
from al_questioner.support.arrays import Array

EXACT_OPERATIONS = 2e10
"""Largest cost of an exact look-ahead, in multiplications and additions (some seconds); above, it is approximated."""

PROBABILITY_TOLERANCE = 8e-7
"""Largest bound on the error of a degree in a look-ahead; what may exceed it is computed by refitting."""

CHUNK_NUMBERS = 4_000_000
"""Largest array of a look-ahead beside its result, in numbers: about 200 MB."""

_LOGGER = logging.getLogger(__name__)


class ConceptModels:
    """Classifiers of every symbol y: q_y(x) is the degree to which an object x is a y (docs/explanation/method.md).

    All classifiers learn from the same examples: a label y is a positive example for y and a negative one for every
    other symbol, the label `NO_SYMBOL` is negative for all. Without examples q is 1/2; examples of one class are valid.

    Args:
        symbols: names of the concepts; they order the columns of every result.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel, in the unit of the features; None for a multiple of the root of their
            number.
        relative_length_scale: this multiple.
        shape: how the kernel treats groups of features and single large differences.
        class_balance: how much of the effect of the counts of examples is removed from the degrees: 0 none, 1 all.

    Raises:
        InputError: no symbols or a repeated one, an amplitude or length scale that is not a number above 0, or a class
            balance outside [0, 1].
    """

    def __init__(
        self,
        symbols: Sequence[str],
        amplitude: float = 4.0,
        length_scale: float | None = None,
        relative_length_scale: float = 1.0,
        shape: KernelShape = RBF,
        class_balance: float = 0.0,
    ) -> None:
        self.symbols = tuple(symbols)
        if not self.symbols or len(set(self.symbols)) < len(self.symbols) or NO_SYMBOL in self.symbols:
            raise InputError(f'symbols must be distinct names other than {NO_SYMBOL!r}, not {list(symbols)}')
        self.kernels = KernelFamily(amplitude, length_scale, relative_length_scale, shape)
        if not 0 <= class_balance <= 1:
            raise InputError(f'class_balance must lie in [0, 1], not {class_balance}')
        self.class_balance = class_balance
        self._labels: tuple[str, ...] = ()
        self._classifiers = BinaryClassifiers(len(self.symbols), self.kernels)
        self._last_seen: tuple[Array, Marginals] | None = None
        self._last_table: tuple[bool, Array] | None = None
        self._warned = False

    def fit(self, features: ArrayLike, labels: Sequence[str], groups: Sequence[str] | None = None) -> ConceptModels:
        """Fit every classifier, and return the models themselves.

        If the labels continue those of the last fit, the fit starts from its result. If one label was added to the same
        features, the new modes follow from the old by the steps of the look-ahead. The result equals that of a fresh
        fit to about 1e-9.

        Args:
            features: (n, m) standardised features; n = 0 removes all examples.
            labels: n names, each a symbol or `NO_SYMBOL`.
            groups: m names, the group of each feature; None for one group of all.

        Raises:
            InputError: a shape that does not fit, a value that is not finite, or an unknown label.
        """
        names = tuple(labels)
        points = self._checked(features, names, groups)
        self._classifiers.fit(points, self.targets_of(names), groups)
        self._labels = names
        self._last_seen = self._last_table = None
        return self

    def refitted(self, features: ArrayLike, groups: Sequence[str] | None = None) -> ConceptModels:
        """Return new models of the same labels on (n, m') other features of the n objects, for example a subset.

        The groups are those of the m' features, None for one group.

        Raises:
            InputError: not n rows, or a value that is not finite.
        """
        points = self._checked(features, self._labels, groups)
        models = self._without_examples(self.kernels)
        models._classifiers, models._labels = self._classifiers.refitted(points, groups), self._labels
        return models

    def predict_each_from_others(self) -> Array:
        """Return the (n, |Y|) degrees of the n examples, each by models of the other examples only.

        Examples of the same features are left out together: they would vote for each other. Every example takes a fit.
        """
        points, groups = self._classifiers.points, self._classifiers.groups
        found = np.empty((len(points), len(self.symbols)))
        for row, point in enumerate(points):
            others = (points != point).any(axis=1)
            models = self._without_examples(self.kernels)
            models.fit(points[others], list(itertools.compress(self._labels, others)), groups)
            found[row] = models.predict_proba(point[None])[0]
        return found

    def targets_of(self, labels: Sequence[str]) -> Array:
        """Return (|Y|, n) targets of n labels: 1 where the label is positive for the symbol, 0 where it is negative."""
        return np.array([[float(label == symbol) for label in labels] for symbol in self.symbols])

    def check_labels(self, labels: Sequence[str]) -> None:
        """Make sure that labels are symbols or `NO_SYMBOL`.

        Raises:
            InputError: one is not.
        """
        for label in labels:
            if label not in self.symbols and label != NO_SYMBOL:
                raise InputError(f'unknown label {label!r}; known: {", ".join((*self.symbols, NO_SYMBOL))}')

    def length_scale_of(self, n_features: int) -> float:
        """Return the kernel's length scale for this number of features, in their unit."""
        return self.kernels.kernel_of(n_features).length_scale

    def with_kernel(self, amplitude: float, relative_length_scale: float) -> ConceptModels:
        """Return models without examples and with another kernel; its length scale is a multiple of the root of m.

        Raises:
            InputError: a number that is not above 0.
        """
        models = self._without_examples(KernelFamily(amplitude, None, relative_length_scale, self.kernels.shape))
        models._warned = self._warned
        return models

    def predict_proba(self, features: ArrayLike) -> Array:
        """Return the (k, |Y|) degrees q_y(x), in (0, 1) and not normalised over y, of (k, m) standardised features.

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        marginals = self._marginals(self._matching(features))
        if not self._labels:
            # Exactly 1/2; the approximation of the logistic function has an error at 0.
            return np.full((len(marginals.mean[0]), len(self.symbols)), 0.5)
        degrees = expected_logistic(marginals.mean, self.kernels.amplitude - marginals.explained).T
        return self._balanced(degrees, self._counts())

    @property
    def classes_(self) -> NDArray[np.str_]:
        """Symbols, (|Y|,), under the name that scikit-learn uses."""
        return np.array(self.symbols)

    def predict(self, features: ArrayLike) -> NDArray[np.str_]:
        """Return the (k,) most probable symbols of (k, m) standardised features, the first of equal ones.

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        best = self.predict_proba(features).argmax(axis=1)
        return np.array([self.symbols[column] for column in best])

    def score(self, features: ArrayLike, labels: Sequence[str]) -> float:
        """Return the share of k > 0 objects, (k, m) standardised features, whose most probable symbol is the true one.

        Raises:
            InputError: not k rows of m columns, none at all, or a value that is not finite.
        """
        found = self.predict(features)
        if len(found) != len(labels) or not len(found):
            raise InputError(f'{len(labels)} labels for {len(found)} feature vectors')
        return float(np.mean(found == np.asarray(labels)))

    def look_ahead(self, scene_features: ArrayLike, exact: bool | None = None) -> Array:
        """Return the predictions for a scene if one of its objects were labelled.

        A classifier only sees whether the new example is positive or negative, so the effects of all |X| |Y| labels on
        |Y| classifiers follow from 2 |X| |Y| hypotheses. None is fitted: all are computed from the present posterior,
        see docs/explanation/look_ahead.md, and a hypothesis whose error may exceed 8e-7 is refitted.

        Args:
            scene_features: (|X|, m) standardised features.
            exact: False for an approximation that takes some 10 |X| |Y| n (|X| + n) operations
                (docs/results/look_ahead.md gives its error); None to use it, with a warning, above `EXACT_OPERATIONS`.

        Returns:
            (|X|, |Y|, |X|, |Y|): [i, j] is `predict_proba(scene_features)` if object i were labelled symbol j.

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        scene = self._matching(scene_features)
        shape = (len(scene), len(self.symbols))
        expected = np.empty((*shape, *shape))
        for rows, part in self.look_ahead_chunks(scene, exact):
            expected[rows] = part
        return expected

    def look_ahead_chunks(self, scene_features: ArrayLike, exact: bool | None = None) -> Iterator[tuple[slice, Array]]:
        """Yield `look_ahead` in parts, for pools whose whole table does not fit into memory.

        The models must not be fitted between the parts. The arguments are those of `look_ahead`.

        Yields:
            Consecutive rows of the table, as a slice, and their part of it, (e, |Y|, |X|, |Y|).

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        scene = self._matching(scene_features)
        marginals = self._marginals(scene)
        n_things, n_symbols, n = len(scene), len(self.symbols), len(self._labels)
        if exact is None:
            exact = self._is_affordable(n_things)
        if self._last_table is not None and self._last_table[0] == exact:
            # A turn without a query changes neither the models nor the scene.
            yield slice(0, n_things), self._last_table[1].copy()
            return
        # The five terms of the expected logistic function and a part's copies for every label need memory, too.
        per_thing = 2 * n_symbols * n_things * max(n_symbols, 5, n if exact else 0)
        size = max(1, CHUNK_NUMBERS // max(1, per_thing))
        own, tolerance = np.arange(n_symbols), self._tolerance() if exact else None
        for first in range(0, n_things, size):
            things = np.arange(first, min(first + size, n_things))
            as_negative, as_positive = self._classifiers.predict_each(scene, marginals, things, tolerance)
            part = np.repeat(as_negative.transpose(1, 2, 0)[:, None], n_symbols, axis=1)
            part[:, own, :, own] = as_positive
            part = self._balanced(part, (self._counts() + np.eye(n_symbols))[:, None])
            if len(things) == n_things:
                self._last_table = exact, part.copy()
            yield slice(first, first + len(things)), part

    def predict_after_each(self, examples: ArrayLike, labels: Sequence[str], features: ArrayLike) -> Array:
        """Return the predictions for objects after one more example, for several such examples, each alone.

        As in `look_ahead`, only a hypothesis whose error may exceed 8e-7 is fitted.

        Args:
            examples: (e, m) standardised features.
            labels: e names, each a symbol or `NO_SYMBOL`.
            features: (k, m) standardised features of the objects.

        Returns:
            (e, k, |Y|): [i] is `predict_proba(features)` if the i-th example had been learnt.

        Raises:
            InputError: not m columns, a value that is not finite, or labels that do not fit.
        """
        new, things = self._matching(examples), self._matching(features)
        if len(labels) != len(new):
            raise InputError(f'{len(labels)} labels for {len(new)} feature vectors')
        self.check_labels(labels)
        points = np.concatenate([new, things])
        marginals = self._classifiers.at(points)
        n_symbols, own = len(self.symbols), np.array([[label == symbol for symbol in self.symbols] for label in labels])
        found = np.empty((len(new), len(things), n_symbols))
        per_example = 2 * n_symbols * len(points) * max(5, len(self._labels))
        size = max(1, CHUNK_NUMBERS // per_example)
        for first in range(0, len(new), size):
            rows = np.arange(first, min(first + size, len(new)))
            as_negative, as_positive = (
                table[:, :, len(new) :]
                for table in self._classifiers.predict_each(points, marginals, rows, self._tolerance())
            )
            found[rows] = np.where(own[rows].T[:, :, None], as_positive, as_negative).transpose(1, 2, 0)
        return self._balanced(found, (self._counts() + own)[:, None])

    def _without_examples(self, kernels: KernelFamily) -> ConceptModels:
        return ConceptModels(
            self.symbols,
            kernels.amplitude,
            kernels.length_scale,
            kernels.relative_length_scale,
            kernels.shape,
            self.class_balance,
        )

    def _checked(self, features: ArrayLike, labels: Sequence[str], groups: Sequence[str] | None) -> Array:
        """Return a copy of the features of examples, after a check that all fits together."""
        points = _matrix(features).copy()
        if groups is not None and len(points) and len(groups) != points.shape[1]:
            raise InputError(f'{len(groups)} groups for {points.shape[1]} features')
        if len(labels) != len(points):
            raise InputError(f'{len(labels)} labels for {len(points)} feature vectors')
        self.check_labels(labels)
        return points

    def _counts(self) -> Array:
        """Return the (|Y|,) numbers of positive examples."""
        return np.array([self._labels.count(symbol) for symbol in self.symbols], dtype=np.float64)

    def _balanced(self, degrees: Array, counts: Array) -> Array:
        return balance_degrees(degrees, counts, self.class_balance)

    def _tolerance(self) -> float:
        """Return the error of a degree, after one more example, that balancing makes no larger than it may be."""
        after = self._counts() + np.eye(len(self.symbols))
        return PROBABILITY_TOLERANCE / largest_slope(after, self.class_balance)

    def _is_affordable(self, n_things: int) -> bool:
        """Return whether an exact look-ahead takes no more than some seconds; if not, log a warning once."""
        operations = exact_operations(n_things, len(self.symbols), len(self._labels))
        if operations > EXACT_OPERATIONS and not self._warned:
            self._warned = True
            text = 'look-ahead approximates: %d things, %d symbols and %d labels would cost %.0e operations'
            _LOGGER.warning(text, n_things, len(self.symbols), len(self._labels), operations)
        return operations <= EXACT_OPERATIONS

    def _marginals(self, points: Array) -> Marginals:
        """Return the beliefs at points; the last result is kept, because a turn asks about its scene repeatedly."""
        if self._last_seen is None or not np.array_equal(self._last_seen[0], points):
            self._last_seen = points.copy(), self._classifiers.at(points)
            self._last_table = None
        return self._last_seen[1]

    def _matching(self, features: ArrayLike) -> Array:
        points = _matrix(features)
        found, fitted = points.shape[1], self._classifiers.points.shape[1]
        if self._labels and found != fitted:
            raise InputError(f'features have {found} columns, the models were fitted on {fitted}')
        return points


def exact_operations(n_things: int, n_symbols: int, n_labels: int) -> float:
    """Return the cost of an exact look-ahead in multiplications and additions, which `EXACT_OPERATIONS` limits."""
    return 8.0 * n_symbols * (n_things * n_labels) ** 2


def compile_models() -> None:
    """Compile the loops of the look-ahead, so that no turn waits for it.

    This takes about ten seconds if they were never compiled before, otherwise half a second.
    """
    ConceptModels(('a', 'b')).fit([[0.0], [1.0]], ('a', 'b')).look_ahead([[0.5]])


def _matrix(features: ArrayLike) -> Array:
    try:
        matrix = np.asarray(features, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError('features are not a table of numbers') from None
    if matrix.shape == (0,):
        return np.empty((0, 0))
    if matrix.ndim != 2:
        raise InputError(f'features must have a row per thing and a column per feature, not shape {matrix.shape}')
    if len(matrix) and matrix.shape[1] == 0:
        raise InputError(f'features have shape {matrix.shape}: there is nothing to tell things apart by')
    if not np.isfinite(matrix).all():
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise InputError(f'features[{row}, {column}] is not finite ({matrix[row, column]})')
    return matrix
