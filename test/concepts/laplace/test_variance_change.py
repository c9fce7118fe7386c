"""Variances and covariances after a change of the curvatures, against dense linear algebra."""

import numpy as np
import pytest
from scipy.special import expit

from al_questioner.concepts.laplace.variance_change import covariance_tangent, spectrum_bounds, variance_drops


def square_root(matrix):
    values, vectors = np.linalg.eigh(matrix)
    return (vectors * np.sqrt(np.maximum(values, 0))) @ vectors.T


def changes(case, h, least, most, seed=0):
    return np.random.default_rng(seed).uniform(least, most, size=(len(case.targets), h, len(case.kernel)))


def exact_covariance(case, curvature, y, relative):
    """(n + k, n + k) posterior covariance of examples and points, with curvatures W (1 + E)."""
    n = len(case.kernel)
    prior = np.block([[case.kernel, case.cross], [case.cross.T, case.among]])
    weights = np.concatenate([curvature(case.posterior.modes[y]) * (1 + relative), np.zeros(len(case.among))])
    return n, case.covariance(weights, prior)


@pytest.mark.parametrize(('least', 'most'), [(-0.9, 0.0), (0.0, 3.0), (-0.5, 0.5), (-0.99, 40.0), (0.0, 0.0)])
def test_spectrum_lies_within_its_bounds(problem, least, most):
    """Otherwise the bounds of the variances would be wrong, too."""
    for n in (1, 5, 30):
        case = problem(n, n, 25.0)
        relative = changes(case, 6, least, most)
        relative[:, 0] *= 1e-3
        lower, upper = spectrum_bounds(case.posterior.covariance, relative)
        assert lower.shape == upper.shape == (3, 6)
        assert ((lower > -1) & (lower <= 0) & (upper >= 0)).all()
        for y, covariance in enumerate(case.posterior.covariance):
            root = square_root(covariance)
            for h, change in enumerate(relative[y]):
                values = np.linalg.eigvalsh(root * change @ root)
                assert lower[y, h] - 1e-12 <= values[0]
                assert values[-1] <= upper[y, h] + 1e-12


@pytest.mark.parametrize('n', [1, 7, 8, 30])
@pytest.mark.parametrize(('least', 'most'), [(-0.02, 0.02), (-0.3, 0.3), (-0.3, 0.0), (0.0, 0.3)])
def test_variances_are_those_of_the_changed_curvatures(problem, curvature, n, least, most):
    """The drop is z' S (I + S)^-1 z; whether or not n fills the registers, and with rows that converge at their own."""
    case = problem(n + 2, n, 4.0)
    relative = changes(case, 6, least, most)
    relative[:, ::2] *= 0.01
    bounds = spectrum_bounds(case.posterior.covariance, relative)
    drops, error = variance_drops(case.posterior.covariance, case.marginals.solved, relative, bounds)
    before = case.amplitude - case.marginals.explained
    for y in range(3):
        for h in range(6):
            size, exact = exact_covariance(case, curvature, y, relative[y, h])
            expected = np.diag(exact)[size:]
            assert (np.abs(before[y] - drops[y, h] - expected) <= error[y, h] + 1e-7).all()
    assert (error[:, ::2] <= 8e-6).all(), 'small changes are known well'
    assert (error >= 0).all()


def test_curvatures_that_stay_change_nothing(problem):
    case = problem(0, 10, 4.0)
    relative = np.zeros((3, 2, 10))
    bounds = spectrum_bounds(case.posterior.covariance, relative)
    drops, error = variance_drops(case.posterior.covariance, case.marginals.solved, relative, bounds)
    assert (drops == 0).all()
    assert (error <= 1e-6).all()
    new = case.marginals.solved.transpose(0, 2, 1)[:, :2]
    tangent, error = covariance_tangent(case.posterior.covariance, new, relative, new, bounds)
    np.testing.assert_array_equal(tangent, new)
    assert (error == 0).all()


@pytest.mark.parametrize(('least', 'most'), [(-0.02, 0.02), (-0.5, 0.5), (-0.9, 0.0), (0.0, 5.0)])
@pytest.mark.parametrize('guess', ['none', 'good'])
def test_tangents_are_the_changed_covariances(problem, curvature, least, most, guess):
    """G solves g = c - T E g; between the points and the new example its bound covers what is left open."""
    case = problem(4, 20, 4.0)
    new = case.marginals.solved.transpose(0, 2, 1)
    relative = changes(case, 4, least, most)
    bounds = spectrum_bounds(case.posterior.covariance, relative)
    identity = np.eye(20)
    exact = np.array(
        [
            [np.linalg.solve(identity + t * e, c) for e, c in zip(relative[y], new[y], strict=True)]
            for y, t in enumerate(case.posterior.covariance)
        ]
    )
    start = np.zeros_like(new) if guess == 'none' else exact + 1e-3
    tangent, error = covariance_tangent(case.posterior.covariance, new, relative, start, bounds)
    prior_joint = case.marginals.covariance(np.arange(4), case.among)
    found = prior_joint - np.matmul(relative * tangent, case.marginals.solved)
    for y in range(3):
        deviation = np.sqrt(case.amplitude - case.marginals.explained[y])
        for h in range(4):
            size, covariance = exact_covariance(case, curvature, y, relative[y, h])
            # A point's own z is as long as its posterior standard deviation at most.
            assert (np.abs(found[y, h] - covariance[size + h, size:]) <= error[y, h] * deviation + 1e-7).all()
            if error[y, h] <= 1e-6:
                np.testing.assert_allclose(tangent[y, h], exact[y, h], rtol=0, atol=1e-4)
    if max(most, -least) <= 0.02:
        assert (error <= 1e-5).all(), 'small changes are known well'


def test_one_example_by_hand():
    """N = 1: with T = t the drop of a point of scaled covariance c is c^2 E / (1 + t E)."""
    p = expit(0.7)
    t = p * (1 - p) * 4 / (1 + p * (1 - p) * 4)
    covariance, solved, relative = np.array([[[t]]]), np.array([[[0.5, 0.1]]]), np.array([[[0.2], [-0.2]]])
    bounds = spectrum_bounds(covariance, relative)
    drops, error = variance_drops(covariance, solved, relative, bounds)
    expected = relative[0] * solved[0] ** 2 / (1 + t * relative[0])
    assert (np.abs(drops[0] - expected) <= error[0] + 1e-9).all()
    np.testing.assert_allclose(drops[0], expected, rtol=0, atol=1e-7)
