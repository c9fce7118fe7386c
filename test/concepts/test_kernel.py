"""The kernels are covariances of the formulas, and scikit-learn finds the same classifiers with them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from sklearn.gaussian_process import GaussianProcessClassifier
from sklearn.gaussian_process.kernels import Kernel, NormalizedKernelMixin, StationaryKernelMixin

from al_questioner.concepts import ConceptModels
from al_questioner.concepts.kernel import GROUPED, RBF, KernelShape, rbf_kernel, saturating_kernel
from al_questioner.domain import InputError

GROUPS = ('a',) * 5 + ('b',) + ('c',) * 2
EQUAL = np.full(8, 1 / 8)


class GroupedOracle(StationaryKernelMixin, NormalizedKernelMixin, Kernel):  # type: ignore[misc]
    """The formula as it is written, feature by feature, for scikit-learn."""

    def __init__(self, amplitude: float, length_scale: float, saturation: float, exponent: float) -> None:
        self.amplitude, self.length_scale = amplitude, length_scale
        self.saturation, self.exponent = saturation, exponent

    def __call__(self, first: Any, second: Any = None, eval_gradient: bool = False) -> Any:
        second = first if second is None else second
        weights = [GROUPS.count(group) ** -self.exponent for group in GROUPS]
        kappa = sum(
            weight / sum(weights) * np.exp(-((first[:, j, None] - second[None, :, j]) ** 2) / 2 / self.saturation**2)
            for j, weight in enumerate(weights)
        )
        return self.amplitude * np.exp(self.saturation**2 / self.length_scale**2 * (kappa - 1))

    def diag(self, points: Any) -> Any:
        return np.full(len(points), self.amplitude)


@pytest.mark.parametrize('amplitude', [4.0, 100.0])
@pytest.mark.parametrize('shape', [GROUPED, KernelShape(2.0, 1.0), KernelShape(1.0, 0.0)])
def test_probabilities_equal_scikit_learn_with_the_same_kernel(amplitude: float, shape: KernelShape) -> None:
    """The kernel of the formula is what the classifiers use."""
    rng = np.random.default_rng(3)
    features, test = rng.normal(size=(20, 8)), rng.normal(size=(9, 8))
    labels = ['left' if value > 0 else 'right' for value in features[:, 0] + features[:, 5]]
    oracle = GaussianProcessClassifier(
        GroupedOracle(amplitude, 1.0, shape.saturation, shape.group_exponent), optimizer=None, max_iter_predict=1000
    )
    expected = oracle.fit(features, [label == 'left' for label in labels]).predict_proba(test)[:, 1]
    models = ConceptModels(('left', 'right'), amplitude, shape=shape).fit(features, labels, GROUPS)
    np.testing.assert_allclose(models.predict_proba(test)[:, 0], expected, atol=1e-5)


@given(
    st.integers(0, 1000),
    st.floats(0.3, 10),
    st.floats(0, 1),
    st.floats(0.3, 3),
)
def test_it_is_a_covariance_with_the_amplitude_on_its_diagonal(
    seed: int, saturation: float, exponent: float, length_scale: float
) -> None:
    """Equal points have exactly the amplitude, and no linear combination has a negative variance."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(12, 8)) * rng.choice([0.01, 1.0, 30.0])
    points[5] = points[2]
    shares = KernelShape(saturation, exponent).shares(GROUPS)
    covariance = saturating_kernel(points, points, 100.0, length_scale, shares, saturation)
    assert (np.diag(covariance) == 100.0).all()
    assert covariance[5, 2] == 100.0
    np.testing.assert_array_equal(covariance, covariance.T)
    assert np.linalg.eigvalsh(covariance).min() > -1e-10


def test_without_saturation_and_with_equal_shares_it_is_the_rbf_kernel() -> None:
    """The limit of the formula is the kernel of the contract, whose length scale is a multiple of sqrt(m)."""
    rng = np.random.default_rng(1)
    first, second = rng.normal(size=(6, 8)), rng.normal(size=(4, 8))
    for saturation in (1e4, 1e7):
        limit = saturating_kernel(first, second, 4.0, 0.7, EQUAL, saturation)
        np.testing.assert_allclose(limit, rbf_kernel(first, second, 4.0, 0.7 * np.sqrt(8)), rtol=1e-6)


@pytest.mark.parametrize('shape', [RBF, GROUPED, KernelShape(np.inf, 1.0)])
def test_copies_of_a_feature_of_a_group_change_nothing_where_groups_count_alike(shape: KernelShape) -> None:
    """With exponent 1, a group of ten equal features weighs as much as a group of one."""
    rng = np.random.default_rng(2)
    points, labels = rng.normal(size=(10, 2)), ['x', 'y'] * 5
    copied = points[:, [0] * 10 + [1]]
    full = KernelShape(shape.saturation, 1.0)
    one = ConceptModels(('x', 'y'), 100.0, shape=full).fit(points, labels, ('a', 'b')).predict_proba(points)
    ten = ConceptModels(('x', 'y'), 100.0, shape=full).fit(copied, labels, ('a',) * 10 + ('b',)).predict_proba(copied)
    np.testing.assert_allclose(ten, one, atol=1e-9)


def test_large_differences_are_computed_in_parts_with_the_same_result(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousand examples of many features do not need a table of all differences at once."""
    rng = np.random.default_rng(4)
    first, second = rng.normal(size=(17, 8)), rng.normal(size=(5, 8))
    whole = saturating_kernel(first, second, 4.0, 1.0, EQUAL, 2.0)
    monkeypatch.setattr('al_questioner.concepts.kernel.CHUNK_NUMBERS', 100)
    np.testing.assert_array_equal(saturating_kernel(first, second, 4.0, 1.0, EQUAL, 2.0), whole)


@pytest.mark.parametrize(('saturation', 'exponent'), [(0.0, 0.5), (-1.0, 0.5), (np.nan, 0.5), (2.0, -0.1), (2.0, 1.1)])
def test_a_shape_out_of_range_is_refused(saturation: float, exponent: float) -> None:
    """Other values give no covariance, or none that means anything."""
    with pytest.raises(InputError, match=r'saturation|exponent'):
        KernelShape(saturation, exponent)


def test_groups_of_another_number_of_features_are_refused() -> None:
    """The models that were fitted stay."""
    models = ConceptModels(('x', 'y'), shape=GROUPED).fit([[0.0, 1.0]], ['x'], ('a', 'b'))
    before = models.predict_proba([[0.5, 0.5]])
    with pytest.raises(InputError, match='3 groups for 2 features'):
        models.fit([[0.0, 1.0], [1.0, 0.0]], ['x', 'y'], ('a', 'b', 'c'))
    np.testing.assert_array_equal(models.predict_proba([[0.5, 0.5]]), before)
