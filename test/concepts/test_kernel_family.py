"""Kernels of any number of features."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist

from al_questioner.concepts import Kernel
from al_questioner.concepts.kernel import GROUPED, saturating_kernel
from al_questioner.concepts.kernel_family import KernelFamily
from al_questioner.domain import InputError


def test_the_length_scale_grows_with_the_root_of_the_number_of_features():
    """Otherwise a subset of the features would be compared with the reach that all of them need."""
    assert KernelFamily(4.0).kernel_of(9) == Kernel(4.0, 3.0)
    assert KernelFamily(4.0, relative_length_scale=0.5).kernel_of(16) == Kernel(4.0, 2.0)
    assert KernelFamily(4.0, 7.0, 0.5).kernel_of(16) == Kernel(4.0, 7.0)
    assert KernelFamily(4.0).kernel_of(0) == Kernel(4.0, 1.0)


def test_covariances_are_those_of_the_formula():
    """They are amplitude * exp(-d^2 / (2 length_scale^2)), groups or not."""
    rng = np.random.default_rng(2)
    first, second = rng.normal(size=(5, 4)), rng.normal(size=(3, 4))
    expected = 25 * np.exp(-(cdist(first, second) ** 2) / (2 * 4))
    for groups in (None, ('a', 'a', 'b', 'c')):
        np.testing.assert_allclose(KernelFamily(25.0).covariance(first, second, groups), expected, rtol=1e-12)


def test_the_shape_reaches_the_covariances():
    """Without groups all features are of one; the reach is that of a difference alike in all features."""
    rng = np.random.default_rng(3)
    first, second = rng.normal(size=(5, 4)), rng.normal(size=(3, 4))
    family = KernelFamily(25.0, 6.0, shape=GROUPED)
    for groups, shares in ((None, np.full(4, 0.25)), ('aabc', GROUPED.shares('aabc'))):
        expected = saturating_kernel(first, second, 25.0, 3.0, shares, GROUPED.saturation)
        np.testing.assert_allclose(family.covariance(first, second, groups), expected, rtol=1e-12)


@pytest.mark.parametrize('name', ['amplitude', 'length_scale', 'relative_length_scale'])
@pytest.mark.parametrize('value', [0.0, -1.0, np.nan, np.inf])
def test_numbers_that_are_not_above_0_are_refused(name, value):
    """Otherwise every belief would be NaN, without a word."""
    with pytest.raises(InputError, match=f'^{name} must be a number above 0'):
        KernelFamily(**({'amplitude': 1.0} | {name: value}))
