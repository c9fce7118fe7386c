"""Variances once the curvatures have changed and a point has become an example, against dense linear algebra."""

import numpy as np
import pytest
from scipy.special import expit

from al_questioner.concepts.laplace.gaussian_process import slope_in_variance
from al_questioner.concepts.laplace.variance_change import find_variances

TOLERANCE = 4e-7
"""Error of a probability up to which variances are searched for here."""

RANGES = [(0.0, 0.0), (-0.02, 0.02), (-0.5, 0.5), (-0.999, 0.0), (0.0, 30.0), (-0.99, 1000.0)]


def searched(case, relative, steps=None):
    """Return the curvatures of the new examples, and variances and bounds for every point as the new example."""
    k = case.cross.shape[1]
    rng = np.random.default_rng(1)
    curvature = rng.uniform(0, 0.25, size=(len(case.targets), k))
    cross = case.marginals.covariance(np.arange(k), case.among)
    arguments = (
        case.posterior.covariance,
        case.marginals.solved.transpose(0, 2, 1),
        relative,
        np.arange(k),
        curvature,
        case.amplitude - case.marginals.explained,
        cross,
        TOLERANCE,
    )
    return curvature, *(find_variances(*arguments) if steps is None else find_variances(*arguments, steps))


def changes(case, least, most):
    """Return (|Y|, k, n) relative changes, small ones in every other hypothesis."""
    shape = len(case.targets), case.cross.shape[1], len(case.kernel)
    relative = np.random.default_rng(0).uniform(least, most, size=shape)
    relative[:, ::2] *= 0.01
    return relative


def exact_variances(case, curvature_of, y, relative, new, curvature):
    """Return (k,) variances of the points by dense algebra over the examples, the new one and the points."""
    prior = np.block([[case.kernel, case.cross], [case.cross.T, case.among]])
    weights = np.concatenate([curvature_of(case.posterior.modes[y]) * (1 + relative), np.zeros(len(case.among))])
    weights[len(case.kernel) + new] = curvature
    return np.diag(case.covariance(weights, prior))[len(case.kernel) :]


@pytest.mark.parametrize('amplitude', [1.0, 4.0, 100.0, 300.0])
@pytest.mark.parametrize('n', [1, 7, 8, 30])
@pytest.mark.parametrize(('least', 'most'), RANGES)
def test_variances_are_those_of_the_changed_curvatures(problem, curvature, amplitude, n, least, most):
    """However the curvatures change, what is found lies within its bound, and no bound is too large to be used."""
    case = problem(n + 2, n, amplitude)
    relative = changes(case, least, most)
    weights, found, error = searched(case, relative)
    for y in range(3):
        for h in range(4):
            expected = exact_variances(case, curvature, y, relative[y, h], h, weights[y, h])
            assert (np.abs(found[y, h] - expected) <= error[y, h] + 1e-9 * amplitude).all()
    assert (error >= 0).all()
    assert (slope_in_variance(np.maximum(found, 0)) * error <= TOLERANCE).all()


@pytest.mark.parametrize('steps', [1, 2])
def test_a_search_that_is_cut_short_says_so(problem, curvature, steps):
    """Nothing that is wrong may be taken for right."""
    case = problem(4, 40, 100.0)
    relative = changes(case, -0.9, 2.0)
    weights, found, error = searched(case, relative, steps)
    wrong = 0
    for y in range(3):
        for h in range(4):
            expected = exact_variances(case, curvature, y, relative[y, h], h, weights[y, h])
            assert (np.abs(found[y, h] - expected) <= error[y, h] + 1e-7).all()
            wrong += int((np.abs(found[y, h] - expected) > 1e-5).sum())
    assert wrong > 0


def test_each_hypothesis_is_what_it_is_alone(problem, monkeypatch):
    """Hypotheses share matrix products, and leave them when they are known."""
    case = problem(3, 20, 100.0)
    relative = changes(case, -0.9, 3.0)
    weights, found, _ = searched(case, relative)
    points, variance = case.marginals.solved.transpose(0, 2, 1), case.amplitude - case.marginals.explained
    cross = case.marginals.covariance(np.arange(4), case.among)
    for h in range(4):
        only = slice(h, h + 1)
        alone, _ = find_variances(
            case.posterior.covariance,
            points,
            relative[:, only],
            np.array([h]),
            weights[:, only],
            variance,
            cross[:, only],
            TOLERANCE,
        )
        np.testing.assert_allclose(alone[:, 0], found[:, h], rtol=0, atol=1e-9)


def test_one_example_by_hand():
    """N = 1: with T = t the variance of a point of scaled covariance c falls by c^2 E / (1 + t E)."""
    p = expit(0.7)
    t = p * (1 - p) * 4 / (1 + p * (1 - p) * 4)
    covariance, points, relative = np.array([[[t]]]), np.array([[[0.5], [0.1]]]), np.array([[[0.2], [-0.2]]])
    nothing, variance = np.zeros((1, 2)), np.array([[3.0, 3.5]])
    found, error = find_variances(
        covariance, points, relative, np.array([0, 1]), nothing, variance, np.zeros((1, 2, 2)), TOLERANCE
    )
    expected = variance - relative[0] * points[0, :, 0] ** 2 / (1 + t * relative[0])
    assert (np.abs(found[0] - expected) <= error[0] + 1e-12).all()
    np.testing.assert_allclose(found[0], expected, rtol=0, atol=1e-5)
