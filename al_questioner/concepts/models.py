"""One binary Gaussian process classifier per symbol, and what they would say after one more label."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import expit

from al_questioner.concepts.gaussian_process import Array, Index, find_modes, predict_probabilities, rbf_kernel
from al_questioner.domain import NO_SYMBOL, InputError

MAX_BATCH_NUMBERS = 1_000_000
"""Largest stack of kernel matrices that a look-ahead holds at once, in numbers: bounds its memory to some 50 MB."""


class ConceptModels:
    """q_y(x), the degree to which a thing x is a y, for every symbol y (DESIGN section 4).

    All classifiers learn from the same examples: a label y is a positive example for y and a negative one for every
    other symbol, the label `NO_SYMBOL` is negative for all. Without examples q is 1/2; examples of one class are valid.

    Args:
        symbols: names of the concepts; they order the columns of every result.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: of the kernel, in the unit of the features; None for the square root of their number.

    Raises:
        InputError: no symbols or a repeated one, or an amplitude or length scale that is not a number above 0.
    """

    def __init__(self, symbols: Sequence[str], amplitude: float = 4.0, length_scale: float | None = None) -> None:
        self.symbols = tuple(symbols)
        if not self.symbols or len(set(self.symbols)) < len(self.symbols) or NO_SYMBOL in self.symbols:
            raise InputError(f'symbols must be distinct names other than {NO_SYMBOL!r}, not {list(symbols)}')
        for name, value in (('amplitude', amplitude), ('length_scale', length_scale)):
            if value is not None and not (np.isfinite(value) and value > 0):
                raise InputError(f'{name} must be a number above 0, not {value}')
        self.amplitude = amplitude
        self.length_scale = length_scale
        self._features: Array = np.empty((0, 0))
        self._targets: Array = np.empty((len(self.symbols), 0))
        self._kernel: Array = np.empty((0, 0))
        self._modes: Array = np.empty((len(self.symbols), 0))

    def fit(self, features: ArrayLike, labels: Sequence[str]) -> ConceptModels:
        """Learn every classifier anew.

        Args:
            features: (n, m) standardised features; n = 0 forgets everything.
            labels: n names, each a symbol or `NO_SYMBOL`.

        Returns:
            The models themselves.

        Raises:
            InputError: a shape that does not fit, a value that is not finite, or an unknown label.
        """
        points = _matrix(features)
        if len(labels) != len(points):
            raise InputError(f'{len(labels)} labels for {len(points)} feature vectors')
        for label in labels:
            if label not in self.symbols and label != NO_SYMBOL:
                raise InputError(f'unknown label {label!r}; known: {", ".join((*self.symbols, NO_SYMBOL))}')
        self._features = points
        self._targets = np.array([[float(label == symbol) for label in labels] for symbol in self.symbols])
        self._kernel = self._covariance(points, points)
        self._modes = find_modes(self._kernel[None], self._owners(), self._targets, start=np.zeros_like(self._targets))
        return self

    def predict_proba(self, features: ArrayLike) -> Array:
        """Degree to which each thing belongs to each symbol.

        Args:
            features: (k, m) standardised features.

        Returns:
            (k, |Y|) q_y(x) in (0, 1), not normalised over y.

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        points = self._points(features)
        if len(self._features) == 0:
            return np.full((len(points), len(self.symbols)), 0.5)
        cross = self._covariance(self._features, points)
        return predict_probabilities(
            self._kernel[None], self._owners(), self._targets, self._modes, cross[None], self.amplitude
        ).T

    def look_ahead(self, scene_features: ArrayLike) -> Array:
        """What the models would say of a scene if one of its things had been labelled.

        A classifier only sees whether the new example is positive or negative, so 2 |X| |Y| refits tell all |X| |Y|
        labels' effects on |Y| classifiers. They start from the present mode and run to convergence.

        Args:
            scene_features: (|X|, m) standardised features.

        Returns:
            (|X|, |Y|, |X|, |Y|): [i, j] is `predict_proba(scene_features)` had thing i been labelled symbol j.

        Raises:
            InputError: not m columns, or a value that is not finite.
        """
        scene = self._points(scene_features)
        n_objects, n_symbols = len(scene), len(self.symbols)
        n = len(self._features) + 1
        per_chunk = max(1, MAX_BATCH_NUMBERS // (2 * n_symbols * n * max(n, n_objects)))
        chunks = [scene[first : first + per_chunk] for first in range(0, max(n_objects, 1), per_chunk)]
        as_negative, as_positive = np.concatenate([self._refitted_with_each(c, scene) for c in chunks], axis=2)

        expected = np.repeat(as_negative.transpose(1, 2, 0)[:, None], n_symbols, axis=1)
        own = np.arange(n_symbols)
        expected[:, own, :, own] = as_positive
        return expected

    def _refitted_with_each(self, extra: Array, scene: Array) -> Array:
        """(2, |Y|, e, |X|) prediction of every classifier had each of e extra things been a negative, a positive."""
        n_extra, n_symbols, n = len(extra), len(self.symbols), len(self._features)
        known = self._features if n else np.empty((0, scene.shape[1]))
        kernels = np.empty((n_extra, n + 1, n + 1))
        kernels[:, :n, :n] = self._kernel
        kernels[:, :n, n] = kernels[:, n, :n] = self._covariance(extra, known)
        kernels[:, n, n] = self.amplitude
        cross = np.empty((n_extra, n + 1, len(scene)))
        cross[:, :n] = self._covariance(known, scene)
        cross[:, n] = self._covariance(extra, scene)

        shape = (2, n_symbols, n_extra, n + 1)
        targets = np.empty(shape)
        targets[..., :n] = self._targets[:, None]
        targets[0, ..., n], targets[1, ..., n] = 0, 1
        start = np.zeros(shape)
        # At the mode K^-1 f = y - p (R&W equation 3.17); a zero for the new thing leaves the others where they are.
        start[..., :n] = self._gradient()[:, None]
        owners = np.tile(np.arange(n_extra), 2 * n_symbols)
        flat = targets.reshape(-1, n + 1)
        modes = find_modes(kernels, owners, flat, start.reshape(-1, n + 1))
        predicted = predict_probabilities(kernels, owners, flat, modes, cross, self.amplitude)
        return predicted.reshape(2, n_symbols, n_extra, len(scene))

    def _gradient(self) -> Array:
        """(|Y|, n) derivative of the log likelihood at the modes: y - p."""
        gradient: Array = self._targets - expit(self._modes)
        return gradient

    def _owners(self) -> Index:
        """(|Y|,) all classifiers share kernel 0."""
        return np.zeros(len(self.symbols), dtype=np.intp)

    def _covariance(self, first: Array, second: Array) -> Array:
        scale = np.sqrt(first.shape[1]) if self.length_scale is None else self.length_scale
        return rbf_kernel(first, second, self.amplitude, scale)

    def _points(self, features: ArrayLike) -> Array:
        points = _matrix(features)
        if len(self._features) and points.shape[1] != self._features.shape[1]:
            raise InputError(
                f'features have {points.shape[1]} columns, the models were fitted on {self._features.shape[1]}'
            )
        return points


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
