"""The learner's classifiers as an estimator of scikit-learn, which must be installed: `pip install '.[sklearn]'`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from al_questioner.concepts.concept_models import ConceptModels
from al_questioner.concepts.kernel import KERNEL_SHAPES
from al_questioner.concepts.standardiser import Standardiser
from al_questioner.domain import AMPLITUDE, CLASS_BALANCE, KERNEL_SHAPE, LENGTH_SCALE, InputError
from al_questioner.support.arrays import Array

try:
    from sklearn.base import BaseEstimator, ClassifierMixin
    from sklearn.utils.multiclass import check_classification_targets
    from sklearn.utils.validation import check_is_fitted
except ImportError as error:
    raise ImportError("scikit-learn is not installed: pip install '.[sklearn]'") from error
try:
    from sklearn.utils.validation import validate_data as _validated
except ImportError:
    # Before scikit-learn 1.6 it is a method.
    def _validated(estimator: BaseEstimator, *arrays: object, **options: object) -> Any:
        """Return the arrays as scikit-learn checks them."""
        return estimator._validate_data(*arrays, **options)


class ConceptClassifier(ClassifierMixin, BaseEstimator):
    """Estimator of scikit-learn whose models are the `ConceptModels` of a learner, with its defaults.

    Features are standardised as a learner does it, with the statistics of the examples. Every label, 'none' too, is a
    class. The fit takes n^3 operations for each class: it is meant for some hundred examples.

    Args:
        groups: names, the group of each feature; None for one group of all.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel in standard deviations; None for the root of the number of features.
        kernel_shape: `grouped`, in which large groups of features and large differences count less, or `rbf`.
        class_balance: share of the effect of the counts of examples that is taken from the beliefs, 0 to 1.

    Attributes:
        classes_: the labels, sorted.
        n_features_in_: number of features.
        models_: the `ConceptModels`; their symbols are the places of the classes, as texts.
        standardiser_: the `Standardiser`.
    """

    def __init__(
        self,
        groups: Sequence[str] | None = None,
        amplitude: float = AMPLITUDE.default,
        length_scale: float | None = LENGTH_SCALE.default,
        kernel_shape: str = KERNEL_SHAPE.default,
        class_balance: float = CLASS_BALANCE.default,
    ) -> None:
        self.groups = groups
        self.amplitude = amplitude
        self.length_scale = length_scale
        self.kernel_shape = kernel_shape
        self.class_balance = class_balance

    def fit(self, X: ArrayLike, y: ArrayLike) -> ConceptClassifier:
        """Learn from (n, m) features and their n labels, and return the estimator itself.

        Raises:
            ValueError: arrays that do not fit, values that are not finite, or a parameter out of its range.
        """
        features, labels = _validated(self, X, y)
        check_classification_targets(labels)
        if self.kernel_shape not in KERNEL_SHAPES:
            raise InputError(f'unknown kernel_shape {self.kernel_shape!r}; known: {", ".join(KERNEL_SHAPES)}')
        self.classes_, places = np.unique(labels, return_inverse=True)
        self.standardiser_ = Standardiser(self.n_features_in_)
        self.standardiser_.update(features)
        # Places instead of the labels: these need not be texts, and one may be the name of what is of no symbol.
        self.models_ = ConceptModels(
            [str(place) for place in range(len(self.classes_))],
            self.amplitude,
            self.length_scale,
            shape=KERNEL_SHAPES[self.kernel_shape],
            class_balance=self.class_balance,
        ).fit(self.standardiser_.transform(features), [str(place) for place in places], self.groups)
        return self

    def predict_proba(self, X: ArrayLike) -> Array:
        """Return the (k, number of classes) probabilities of the classes, which add up to 1, of (k, m) features.

        Raises:
            ValueError: not m columns, or a value that is not finite.
            NotFittedError: nothing was learnt yet.
        """
        points = self._standardised(X)
        degrees = self.models_.predict_proba(points)
        shares: Array = degrees / degrees.sum(axis=1, keepdims=True)
        return shares

    def predict(self, X: ArrayLike) -> NDArray[Any]:
        """Return the (k,) most probable classes of (k, m) features, the first of equal ones.

        Raises:
            ValueError: not m columns, or a value that is not finite.
            NotFittedError: nothing was learnt yet.
        """
        points = self._standardised(X)
        places = self.models_.predict(points).astype(int)
        found: NDArray[Any] = self.classes_[places]
        return found

    def _standardised(self, X: ArrayLike) -> Array:
        check_is_fitted(self)
        return self.standardiser_.transform(_validated(self, X, reset=False))
