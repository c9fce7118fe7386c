"""Laplace posteriors against the formulas of Rasmussen and Williams, written out with dense matrices."""

import numpy as np
import pytest
from scipy.special import expit

from al_questioner.concepts.laplace.posterior import laplace_posterior

AMPLITUDES = [1.0, 4.0, 25.0, 100.0]


@pytest.mark.parametrize('duplicates', [False, True])
@pytest.mark.parametrize('amplitude', AMPLITUDES)
@pytest.mark.parametrize('n', [1, 2, 30])
def test_modes_satisfy_their_equation(problem, n, amplitude, duplicates):
    """F = K (y - p(f)): everything else is built on it."""
    posterior = problem(n, n, amplitude, duplicates=duplicates).posterior
    np.testing.assert_allclose(posterior.modes, posterior.gradient @ posterior.kernel, rtol=0, atol=1e-8)


@pytest.mark.parametrize('duplicates', [False, True])
@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_covariance_is_the_scaled_posterior_covariance(problem, curvature, amplitude, duplicates):
    """T = I - B^-1 = W^1/2 (K^-1 + W)^-1 W^1/2, symmetric, and at least 0 and less than 1."""
    case = problem(1, 25, amplitude, duplicates=duplicates)
    for k, covariance in enumerate(case.posterior.covariance):
        w = curvature(case.posterior.modes[k])
        root = np.sqrt(w)
        dense = root[:, None] * case.covariance(w) * root
        np.testing.assert_allclose(covariance, dense, rtol=0, atol=1e-8)
        inverse = np.linalg.inv(np.eye(25) + root[:, None] * case.kernel * root)
        np.testing.assert_allclose(covariance, np.eye(25) - inverse, rtol=0, atol=1e-8)
        np.testing.assert_array_equal(covariance, covariance.T)
        values = np.linalg.eigvalsh(covariance)
        assert values.min() > -1e-12
        assert values.max() < 1


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_marginals_are_those_of_the_textbook(problem, curvature, amplitude):
    """Mean k' (y - p), variance k(x, x) - k' (K + W^-1)^-1 k (R&W equations 3.21 and 3.24), and covariances alike."""
    case = problem(2, 15, amplitude)
    things, marginals = np.array([2, 0]), case.marginals
    joint = marginals.covariance(things, case.among[things])
    for k, modes in enumerate(case.posterior.modes):
        inverse = np.linalg.inv(case.kernel + np.diag(1 / curvature(modes)))
        posterior = case.among - case.cross.T @ inverse @ case.cross
        np.testing.assert_allclose(marginals.mean[k], case.cross.T @ (case.targets[k] - expit(modes)), atol=1e-8)
        np.testing.assert_allclose(amplitude - marginals.explained[k], np.diag(posterior), atol=1e-7)
        np.testing.assert_allclose(joint[k], posterior[things], atol=1e-7)
        # W^1/2 C K^-1 k is the scaled posterior covariance of the examples with the points.
        exact = np.sqrt(curvature(modes))[:, None] * (case.cross - case.kernel @ inverse @ case.cross)
        np.testing.assert_allclose(marginals.solved[k], exact, atol=1e-7)


@pytest.mark.parametrize('amplitude', AMPLITUDES)
def test_the_start_does_not_matter(problem, amplitude):
    """From nothing, from the mode itself, from beside it and from far away, all must come to the same posterior."""
    case = problem(3, 40, amplitude, duplicates=True)
    rng = np.random.default_rng(3)
    for distance in (0.0, 1e-8, 1e-3, 1.0, 30.0):
        start = case.posterior.modes + distance * rng.normal(size=case.targets.shape)
        again = laplace_posterior(case.kernel, case.targets, start)
        np.testing.assert_allclose(again.modes, case.posterior.modes, rtol=0, atol=1e-8)
        np.testing.assert_allclose(again.covariance, case.posterior.covariance, rtol=0, atol=1e-6)
        np.testing.assert_allclose(again.at(case.cross).explained, case.marginals.explained, rtol=0, atol=1e-6)


def test_without_examples_the_prior_holds():
    nothing = np.empty((3, 0))
    posterior = laplace_posterior(np.empty((0, 0)), nothing, nothing)
    marginals = posterior.at(np.empty((0, 2)))
    assert posterior.gradient.shape == (3, 0)
    assert posterior.covariance.shape == (3, 0, 0)
    assert (marginals.mean == 0).all()
    assert (marginals.explained == 0).all()
    assert marginals.mean.shape == marginals.explained.shape == (3, 2)
    prior = np.array([[4.0, 1.0]])
    np.testing.assert_array_equal(marginals.covariance(np.array([0]), prior), np.broadcast_to(prior, (3, 1, 2)))


@pytest.mark.parametrize('n', [50, 400])
@pytest.mark.parametrize('contradicted', [False, True])
def test_saturated_examples(curvature, n, contradicted):
    """One view named hundreds of times at amplitude 100: W is all but 0, and by symmetry a scalar tells the answer."""
    targets = np.ones((1, n))
    if contradicted:
        targets[0, 0] = 0
    kernel = np.full((n, n), 100.0)
    posterior = laplace_posterior(kernel, targets, np.zeros((1, n)))
    mode = posterior.modes[0, 0]
    assert np.ptp(posterior.modes) < 1e-8
    assert mode == pytest.approx(100 * (targets.sum() - n * expit(mode)), abs=1e-6)
    marginals = posterior.at(np.full((n, 1), 100.0))
    assert marginals.mean[0, 0] == pytest.approx(mode, abs=1e-6)
    # n observations of precision W each, of one value of variance 100.
    assert 100 - marginals.explained[0, 0] == pytest.approx(1 / (1 / 100 + n * curvature(mode)), rel=1e-6)
    values = np.linalg.eigvalsh(posterior.covariance[0])
    assert values.min() > -1e-10
    assert values.max() < 1


def test_what_is_no_covariance_is_refused():
    """An indefinite kernel matrix must raise and not give beliefs."""
    kernel = np.array([[1.0, 90.0], [90.0, 1.0]])
    with pytest.raises(ArithmeticError, match='not a covariance'):
        laplace_posterior(kernel, np.array([[1.0, 0.0]]), np.zeros((1, 2)))
