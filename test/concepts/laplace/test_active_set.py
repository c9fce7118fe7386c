"""The few rows of a linear system that are solved exactly."""

import numpy as np
import pytest

from al_questioner.concepts.laplace.active_set import LARGEST_PASSIVE, factorise, select_active, substitute


def test_rows_that_change_much_are_active():
    """A row outside of the active set that is no small one would keep the iteration from converging."""
    covariance = np.diag([1.0, 0.5, 0.01, 0.9])
    relative = np.array([LARGEST_PASSIVE * 0.99, -LARGEST_PASSIVE * 2.02, 1e3, -0.05])
    rows = np.full(4, -1)
    assert select_active(covariance, relative, LARGEST_PASSIVE, rows) == 2
    assert list(rows[:2]) == [1, 2]
    assert select_active(covariance, relative, LARGEST_PASSIVE / 2, rows) == 3


@pytest.mark.parametrize('size', [0, 1, 2, 7, 20])
def test_systems_are_solved(size):
    """Rows are exchanged where a pivot is small; what lies beyond the system is left alone."""
    rng = np.random.default_rng(size)
    matrix, vector = rng.normal(size=(size + 2, size + 2)), rng.normal(size=size + 2)
    if size > 1:
        matrix[0, 0] = 0.0
    expected = np.linalg.solve(matrix[:size, :size], vector[:size])
    rest = vector[size:].copy()
    factors, pivots = matrix.copy(), np.empty(size + 2, np.intp)
    factorise(factors, pivots, size)
    substitute(factors, pivots, size, vector)
    np.testing.assert_allclose(vector[:size], expected, rtol=1e-9, atol=1e-12)
    np.testing.assert_array_equal(vector[size:], rest)
    np.testing.assert_array_equal(factors[size:], matrix[size:])
