"""Classifiers of common examples: a fit that goes on is one from nothing, and what they foresee comes true."""

import numpy as np
import pytest

from al_questioner.concepts.kernel import GROUPED
from al_questioner.concepts.kernel_family import KernelFamily
from al_questioner.concepts.laplace.classifiers import BinaryClassifiers
from al_questioner.concepts.laplace.gaussian_process import expected_logistic

KERNELS = KernelFamily(25.0, shape=GROUPED)


@pytest.fixture
def examples():
    """Features of nine examples, and the targets of three classifiers."""
    rng = np.random.default_rng(6)
    return rng.normal(size=(9, 4)), rng.integers(0, 2, size=(3, 9)).astype(np.float64)


def fitted(points, targets, groups=None):
    """Return classifiers fitted from nothing."""
    classifiers = BinaryClassifiers(len(targets), KERNELS)
    classifiers.fit(points, targets, groups)
    return classifiers


@pytest.mark.parametrize('groups', [None, 'aabb', 'abcd'])
def test_whatever_was_fitted_before_the_fit_is_that_of_the_examples(examples, groups):
    """One example more, several, fewer, other targets or other groups: a warm start would end elsewhere."""
    points, targets = examples
    growing = BinaryClassifiers(3, KERNELS)
    for n, turned, now in (
        (0, False, None),
        (1, False, groups),
        (2, False, groups),
        (6, False, groups),
        (5, False, groups),
        (6, True, groups),
        (7, True, 'aabc'),
        (8, True, groups),
    ):
        wanted = 1 - targets[:, :n] if turned else targets[:, :n]
        growing.fit(points[:n], wanted, now)
        np.testing.assert_allclose(growing.posterior.modes, fitted(points[:n], wanted, now).posterior.modes, atol=1e-8)


def test_refitted_classifiers_have_the_same_targets_on_other_features(examples):
    """A subset that is only imagined would change the classifiers that it is imagined of."""
    points, targets = examples
    classifiers = fitted(points, targets)
    before = classifiers.posterior
    subset = classifiers.refitted(points[:, :2], 'ab')
    expected = fitted(points[:, :2], targets, 'ab')
    np.testing.assert_allclose(subset.posterior.modes, expected.posterior.modes, atol=1e-8)
    assert classifiers.posterior is before
    assert classifiers.points is points


def test_what_is_foreseen_is_what_a_fit_with_one_more_gives(examples):
    """Every question would be weighed by what its answer does not lead to."""
    points, targets = examples
    classifiers, scene = fitted(points[:6], targets[:, :6]), points[6:]
    tables = classifiers.predict_each(scene, classifiers.at(scene), np.array([0, 2]), 8e-7)
    for target, table in enumerate(tables):
        assert table.shape == (3, 2, 3)
        for place, row in enumerate((0, 2)):
            after = fitted(
                np.vstack([points[:6], scene[row]]), np.column_stack([targets[:, :6], np.full(3, float(target))])
            ).at(scene)
            expected = expected_logistic(after.mean, KERNELS.amplitude - after.explained)
            np.testing.assert_allclose(table[:, place], expected, atol=8e-7)
