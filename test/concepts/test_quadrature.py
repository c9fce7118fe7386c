"""Quadratic forms of resolvents against dense linear algebra."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from al_questioner.concepts.quadrature import MOST_STEPS, resolvent_forms

LEAST = (-0.5, -0.01, 0.0)
MOST = (0.0, 0.3)


def covariance_like(rng, n):
    """(n, n) T, symmetric with eigenvalues between 0 and 1 as single precision rounds them, and its root."""
    basis = np.linalg.qr(rng.normal(size=(n, n)))[0]
    matrix = ((basis * rng.uniform(0, 1, size=n) ** 3) @ basis.T).astype(np.float32).astype(np.float64)
    matrix = (matrix + matrix.T) / 2
    values, vectors = np.linalg.eigh(matrix)
    return matrix, (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T


def dense(root, change, start):
    """V' (I + S)^-1 v, and the ends of the spectrum of S."""
    spectrum = root @ np.diag(change) @ root
    vector = root @ start
    ends = np.linalg.eigvalsh(spectrum)[[0, -1]]
    return vector @ np.linalg.solve(np.eye(len(vector)) + spectrum, vector), ends, vector @ vector


def case(seed, n, n_rows, least, most):
    """Rows of u and E in single precision; E reaches from `least` to `most`, and each row has its own size."""
    rng = np.random.default_rng(seed)
    matrix, root = covariance_like(rng, n)
    change = rng.uniform(least, most, size=(n_rows, n)) * rng.choice([1.0, 0.1, 0.001], size=(n_rows, 1))
    change[0] = rng.choice([least, most], size=n)
    start = rng.normal(size=(n_rows, n))
    return matrix, root, start.astype(np.float32), change.astype(np.float32)


def spread_by(matrix):
    """T times each vector, in single precision as the package does it."""
    single = matrix.astype(np.float32)
    return lambda vectors, rows: vectors @ single


def exact_and_bounds(root, start, change):
    """Dense forms, tight bounds of each spectrum, and |v|^2."""
    rows = [dense(root, e.astype(np.float64), u.astype(np.float64)) for e, u in zip(change, start, strict=True)]
    exact, lengths = np.array([row[0] for row in rows]), np.array([row[2] for row in rows])
    lower = np.array([min(row[1][0], 0.0) for row in rows])
    upper = np.array([max(row[1][1], 0.0) for row in rows])
    return exact, lower, upper, lengths


@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 40),
    least=st.sampled_from(LEAST),
    most=st.sampled_from(MOST),
    slack=st.sampled_from([1.0, 0.5]),
)
@settings(deadline=None, max_examples=150)
def test_value_lies_within_its_bound(seed, n, least, most, slack):
    """An error bound that does not hold would let a wrong probability pass for an exact one.

    With bounds of the spectrum that are tight, and with some that are as loose as -1 < lower <= 0 <= upper permits.
    """
    matrix, root, start, change = case(seed, n, 6, least, most)
    exact, lower, upper, lengths = exact_and_bounds(root, start, change)
    lower, upper = lower + (1 - slack) * (-0.999 - lower), upper / slack
    value, error = resolvent_forms(start, change, spread_by(matrix), lower, upper, 1e-6)
    assert np.isfinite(error).all()
    # Single precision knows the vector's own length no better than this.
    rounding = 1e-6 * lengths / (1 + lower) ** 2 * (1 + np.sqrt(np.abs(change)).max(axis=1))
    assert (np.abs(value - exact) <= error + rounding).all()


@pytest.mark.parametrize('seed', range(5))
def test_few_steps_suffice_for_small_changes(seed):
    """Bounds that hold but never become narrow would make everything be refitted."""
    matrix, root, start, change = case(seed, 30, 8, -0.05, 0.05)
    exact, lower, upper, lengths = exact_and_bounds(root, start, change)
    value, error = resolvent_forms(start, change, spread_by(matrix), lower, upper, 0.0)
    assert (error <= 3e-6 * lengths).all()
    np.testing.assert_allclose(value, exact, rtol=3e-6)


def test_spectrum_of_few_points_is_found_exactly():
    """With as many steps as there are eigenvalues the fraction ends, and only rounding is left of the error."""
    rng = np.random.default_rng(0)
    matrix, root = covariance_like(rng, 4)
    start, change = rng.normal(size=(3, 4)).astype(np.float32), rng.uniform(-0.9, 3, size=(3, 4)).astype(np.float32)
    exact, *_ = exact_and_bounds(root, start, change)
    value, _ = resolvent_forms(start, change, spread_by(matrix), np.full(3, -0.95), np.full(3, 50.0), 0.0)
    np.testing.assert_allclose(value, exact, rtol=1e-4)


def test_vectors_of_zeros_have_forms_of_zero():
    """Padding, points far from all examples, and changes of nothing must not divide by zero."""
    matrix, _, start, change = case(1, 10, 4, -0.5, 2.0)
    start[1], change[2] = 0, 0
    start[3], change[3] = 0, 0
    with np.errstate(all='raise'):
        value, error = resolvent_forms(start, change, spread_by(matrix), np.full(4, -0.6), np.full(4, 3.0), 1e-6)
    assert value[[1, 3]].tolist() == [0, 0]
    assert error[[1, 3]].tolist() == [0, 0]
    length = start[2].astype(np.float64) @ matrix @ start[2]
    assert abs(value[2] - length) <= error[2] + 1e-6 * length


def test_only_open_rows_are_asked_for_in_their_order():
    """The caller multiplies block by block: rows that are out of order would meet another classifier's matrix."""
    matrix, root, start, change = case(2, 40, 9, -0.6, 1.0)
    change[[1, 4, 5]] *= 1e-4
    change[7] *= 0.02
    asked = []

    def spread(vectors, rows):
        assert len(vectors) == len(rows)
        asked.append(rows.copy())
        return vectors @ matrix.astype(np.float32)

    exact, lower, upper, lengths = exact_and_bounds(root, start, change)
    tolerance = 1e-5 * lengths.max()
    value, error = resolvent_forms(start, change, spread, lower, upper, tolerance)
    assert 2 < len(asked) <= MOST_STEPS
    assert asked[0].tolist() == list(range(9))
    for rows, following in itertools.pairwise(asked):
        assert (np.diff(following) > 0).all()
        assert set(following) <= set(rows)
    assert not {1, 4, 5} & set(asked[2])
    assert (np.abs(value - exact) <= error + 1e-5 * lengths / (1 + lower) ** 2).all()


def test_each_row_meets_its_own_matrix_when_others_have_left():
    """Rows of several classifiers that converge at different steps give what each gives alone."""
    rng = np.random.default_rng(3)
    matrices = [covariance_like(rng, 20)[0].astype(np.float32) for _ in range(3)]
    owner = np.repeat(np.arange(3), 4)
    start = rng.normal(size=(12, 20)).astype(np.float32)
    change = (rng.uniform(-0.9, 9, size=(12, 20)) * rng.choice([1e-4, 0.05, 1.0], size=(12, 1))).astype(np.float32)
    lower, upper = np.minimum(change.min(axis=1), 0).astype(float), np.maximum(change.max(axis=1), 0).astype(float)

    def spread(vectors, rows):
        return np.stack([v @ matrices[owner[r]] for v, r in zip(vectors, rows, strict=True)])

    together = resolvent_forms(start, change, spread, lower, upper, 1e-3)
    for row in range(12):
        one = slice(row, row + 1)
        alone = resolvent_forms(
            start[one], change[one], lambda v, _, row=row: v @ matrices[owner[row]], lower[one], upper[one], 1e-3
        )
        np.testing.assert_allclose([together[0][row], together[1][row]], np.concatenate(alone), rtol=1e-4, atol=1e-7)


def test_overflow_of_single_precision_is_no_small_error():
    """Where numbers leave single precision, the bound must say so and not be a number that happens to be small."""
    matrix, root, start, change = case(4, 12, 3, -0.9, 1e30)
    _, lower, upper, lengths = exact_and_bounds(root, start, change)
    with np.errstate(all='ignore'):
        _, error = resolvent_forms(start, change, spread_by(matrix), np.maximum(lower, -0.99), upper, 1e-6)
    assert not (error[0] <= 1e-3 * lengths[0])
