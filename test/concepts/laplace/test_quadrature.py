"""Quadratic forms of resolvents against dense linear algebra."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from al_questioner.concepts.laplace.quadrature import resolvent_forms

LEAST = (-0.95, -0.5, -0.01, 0.0)
MOST = (0.0, 0.3, 5.0, 50.0)


def covariance_like(rng, n):
    """(n, n) T, symmetric with eigenvalues between 0 and 1 as single precision rounds them, and its root."""
    basis = np.linalg.qr(rng.normal(size=(n, n)))[0]
    matrix = ((basis * rng.uniform(0, 1, size=n) ** 3) @ basis.T).astype(np.float32).astype(np.float64)
    matrix = (matrix + matrix.T) / 2
    values, vectors = np.linalg.eigh(matrix)
    return matrix, (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T


def case(seed, n, n_rows, least, most):
    """Changes E from `least` to `most`, each row of its own size, and four points, in single precision."""
    rng = np.random.default_rng(seed)
    matrix, root = covariance_like(rng, n)
    change = rng.uniform(least, most, size=(n_rows, n)) * rng.choice([1.0, 0.1, 0.001], size=(n_rows, 1))
    change[0] = rng.choice([least, most], size=n)
    points = rng.normal(size=(4, n))
    return matrix.astype(np.float32), root, change.astype(np.float32), points.astype(np.float32)


def exact_and_bounds(root, change, points):
    """Dense forms (h, k), tight bounds of each spectrum, and |v|^2 of each."""
    exact, lengths = np.empty((len(change), len(points))), np.empty((len(change), len(points)))
    lower, upper = np.zeros(len(change)), np.zeros(len(change))
    for h, e in enumerate(change.astype(np.float64)):
        spectrum = root * e @ root
        vectors = (points * e) @ root
        exact[h] = np.einsum('kn,nk->k', vectors, np.linalg.solve(np.eye(len(e)) + spectrum, vectors.T))
        lengths[h] = (vectors**2).sum(axis=1)
        values = np.linalg.eigvalsh(spectrum)
        lower[h], upper[h] = min(values[0], 0.0), max(values[-1], 0.0)
    return exact, lower, upper, lengths


@given(
    seed=st.integers(0, 2**32 - 1),
    n=st.integers(1, 40),
    least=st.sampled_from(LEAST),
    most=st.sampled_from(MOST),
    slack=st.sampled_from([1.0, 0.5]),
)
@example(seed=129940, n=1, least=-0.95, most=50.0, slack=1.0)
@settings(deadline=None, max_examples=150)
def test_value_lies_within_its_bound(seed, n, least, most, slack):
    """Otherwise a bound that does not hold would let a wrong probability pass for an exact one.

    With bounds of the spectrum that are tight, and with some that are as loose as -1 < lower <= 0 <= upper permits.
    """
    matrix, root, change, points = case(seed, n, 6, least, most)
    exact, lower, upper, lengths = exact_and_bounds(root, change, points)
    lower, upper = lower + (1 - slack) * (-0.999 - lower), upper / slack
    value, error = resolvent_forms(matrix, change, points, lower, upper, 1e-6)
    assert (error >= 0).all()
    # Single precision knows the vector's own length no better than this.
    rounding = 1e-6 * lengths / (1 + lower[:, None]) ** 2 * (1 + np.sqrt(np.abs(change)).max(axis=1))[:, None]
    assert (np.abs(value - exact) <= error + rounding + 1e-12).all()


@pytest.mark.parametrize('seed', range(5))
def test_few_steps_suffice_for_small_changes(seed):
    """Otherwise bounds that hold but never become narrow would make everything be refitted."""
    matrix, root, change, points = case(seed, 30, 8, -0.05, 0.05)
    exact, lower, upper, lengths = exact_and_bounds(root, change, points)
    value, error = resolvent_forms(matrix, change, points, lower, upper, 0.0)
    # What single precision leaves open depends on u, of which T may leave little.
    rounding = 1e-6 * ((change[:, None] * points) ** 2).sum(axis=2)
    assert (error <= 3e-6 * lengths + 1.2 * rounding).all()
    np.testing.assert_allclose(value, exact, rtol=3e-6)


def test_nothing_has_a_form_of_zero():
    """Padding, points far from all examples, and changes of nothing must not divide by zero."""
    matrix, _, change, points = case(1, 10, 4, -0.5, 0.5)
    change[1], points[2] = 0, 0
    with np.errstate(all='raise'):
        value, error = resolvent_forms(matrix, change, points, np.full(4, -0.6), np.full(4, 3.0), 1e-6)
    for numbers in (value, error):
        assert (numbers[1] == 0).all()
        assert (numbers[:, 2] == 0).all()
        assert np.isfinite(numbers).all()


def test_each_form_is_what_it_is_alone():
    """Forms leave at different steps: those that stay must keep their own vectors and changes."""
    matrix, _, change, points = case(3, 40, 9, -0.6, 1.0)
    change[[1, 4, 5]] *= 1e-3
    lower, upper = np.minimum(change.min(axis=1), 0).astype(float), np.maximum(change.max(axis=1), 0).astype(float)
    together = resolvent_forms(matrix, change, points, lower, upper, 1e-3)
    for h in range(9):
        for k in range(4):
            one = slice(h, h + 1)
            alone = resolvent_forms(matrix, change[one], points[k : k + 1], lower[one], upper[one], 1e-3)
            found = [together[0][h, k], together[1][h, k]]
            np.testing.assert_allclose(found, np.ravel(alone), rtol=1e-4, atol=1e-6)


def test_overflow_of_single_precision_is_no_small_error():
    """The bound says that numbers leave single precision, and is not a number that happens to be small."""
    matrix, _, change, points = case(4, 12, 3, -0.9, 1e30)
    upper = np.maximum(change.max(axis=1), 0).astype(np.float64)
    with np.errstate(all='ignore'):
        _, error = resolvent_forms(matrix, change, points, np.full(3, -0.9), upper, 1e-6)
    assert not (error[0] <= 1e-3).any()
