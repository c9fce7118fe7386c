"""Running statistics against those of the whole table."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.concepts import Standardiser
from al_questioner.domain import InputError


@given(seed=st.integers(0, 2**32 - 1), sizes=st.lists(st.integers(0, 6), min_size=1, max_size=6))
def test_batches_add_up_to_the_whole(seed, sizes):
    """However the observations are cut into scenes, the statistics are those of all of them."""
    table = np.random.default_rng(seed).normal(loc=1000.0, size=(sum(sizes), 3))
    standardiser = Standardiser(3)
    for batch in np.split(table, np.cumsum(sizes)[:-1]):
        standardiser.update(batch)
    assert standardiser.count == len(table)
    if len(table) >= 2:
        np.testing.assert_allclose(standardiser.mean, table.mean(axis=0), rtol=1e-12)
        np.testing.assert_allclose(standardiser.scale, table.std(axis=0), rtol=1e-9)
        standardised = standardiser.transform(table)
        np.testing.assert_allclose(standardised.mean(axis=0), 0, atol=1e-9)
        np.testing.assert_allclose(standardised.std(axis=0), 1, rtol=1e-9)


@pytest.mark.parametrize('value', [0.0, 0.1, 12345.678])
def test_constant_feature_keeps_its_scale(value):
    """Otherwise a division by no spread, or by its rounding, would blow up the first value that differs."""
    standardiser = Standardiser(1)
    for _ in range(7):
        standardiser.update(np.full((3, 1), value, dtype=np.float32))
    assert standardiser.scale.tolist() == [1.0]
    np.testing.assert_allclose(standardiser.transform(np.full((1, 1), np.float32(value))), 0, atol=1e-9)


def test_nothing_observed_changes_nothing():
    np.testing.assert_array_equal(Standardiser(2).transform(np.array([[1.0, 2.0]])), [[1.0, 2.0]])


def test_another_number_of_features_is_refused():
    with pytest.raises(InputError, match=r'expected \(n, 2\)'):
        Standardiser(2).update(np.zeros((1, 3)))
