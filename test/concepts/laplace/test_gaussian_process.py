"""The search for posterior modes: its result from any start, and its cost."""

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.special import expit

from al_questioner.concepts.kernel import rbf_kernel
from al_questioner.concepts.laplace import gaussian_process
from al_questioner.concepts.laplace.gaussian_process import (
    MEAN_SLOPE,
    expected_logistic,
    find_modes,
    slope_in_variance,
)


def clusters(n, classes, amplitude, seed=0):
    """Kernel matrix of things in clusters, and the targets of a classifier of each cluster."""
    rng = np.random.default_rng(seed)
    kinds = np.arange(n) % classes
    points = rng.normal(size=(classes, 60))[kinds] + rng.normal(size=(n, 60))
    return rbf_kernel(points, points, amplitude, 8.0)[None], (kinds == np.arange(classes)[:, None]).astype(float)


@pytest.mark.parametrize('amplitude', [0.01, 1.0, 100.0, 1e4])
@pytest.mark.parametrize('spread', [0.0, 0.5, 30.0])
def test_every_start_leads_to_the_mode(amplitude, spread):
    """The mode obeys f = K (y - p(f)), however far from it the search begins."""
    kernels, targets = clusters(40, 4, amplitude)
    start = spread * np.random.default_rng(1).normal(size=targets.shape)
    modes = find_modes(kernels, np.zeros(4, dtype=np.intp), targets, start)
    np.testing.assert_allclose(modes, (targets - expit(modes)) @ kernels[0], atol=1e-6 * (1 + amplitude))


def test_no_other_point_is_more_probable():
    """A general minimiser of the negative log posterior ends at the same place."""
    (kernel,), targets = clusters(12, 3, 25.0)
    inverse = np.linalg.inv(kernel)

    def loss(latent):
        return 0.5 * latent @ inverse @ latent + np.logaddexp(0, (1 - 2 * targets[0]) * latent).sum()

    found = find_modes(kernel[None], np.zeros(1, dtype=np.intp), targets[:1], np.zeros((1, 12)))[0]
    np.testing.assert_allclose(found, minimize(loss, np.zeros(12), options={'gtol': 1e-9}).x, atol=1e-4)


def test_problems_of_several_kernels_are_told_apart():
    """Each problem is solved with the kernel that it names, also where kernels share targets."""
    first, targets = clusters(20, 2, 4.0, seed=1)
    second, _ = clusters(20, 2, 100.0, seed=2)
    owners = np.array([1, 0, 1, 0])
    together = find_modes(np.concatenate([first, second]), owners, np.tile(targets, (2, 1)), np.zeros((4, 20)))
    for row, owner in enumerate(owners):
        alone = find_modes((first, second)[owner], np.zeros(1, dtype=np.intp), targets[[row % 2]], np.zeros((1, 20)))
        np.testing.assert_array_equal(together[row], alone[0])


@pytest.mark.parametrize('amplitude', [4.0, 100.0, 300.0])
def test_few_matrices_are_factorised(amplitude, monkeypatch):
    """The first one serves all classifiers, then a handful each: this is what a fit of many labels costs."""
    kernels, targets = clusters(200, 8, amplitude)
    original, roots = gaussian_process.cholesky_factor, []

    def factorise(kernel, root, buffer):
        roots.append(root)
        return original(kernel, root, buffer)

    monkeypatch.setattr(gaussian_process, 'cholesky_factor', factorise)
    find_modes(kernels, np.zeros(8, dtype=np.intp), targets, np.zeros_like(targets))
    assert sum((root == 0.5).all() for root in roots) == 1
    assert len(roots) <= 1 + 8 * 5


def test_what_is_not_finite_is_refused():
    """Neither an endless search nor beliefs that are no numbers."""
    kernels, targets = clusters(5, 1, 4.0)
    kernels[0, 2, 2] = np.nan
    with pytest.raises(ArithmeticError):
        find_modes(kernels, np.zeros(1, dtype=np.intp), targets, np.zeros_like(targets))


def test_expected_probabilities_change_no_faster_than_the_bounds_say():
    """The errors of a look-ahead are told by these bounds; they hold for the five terms, not only for the integral."""
    mean, variance = np.meshgrid(np.linspace(-60, 60, 2401), np.concatenate([[0.0], np.geomspace(1e-3, 1e4, 60)]))
    step = 1e-4
    by_mean = np.abs(expected_logistic(mean + step, variance) - expected_logistic(mean - step, variance)) / (2 * step)
    assert (by_mean <= MEAN_SLOPE[0] / np.sqrt(variance + MEAN_SLOPE[1]) + 1e-7).all()
    by_variance = np.abs(expected_logistic(mean, variance + step) - expected_logistic(mean, variance)) / step
    assert (by_variance <= slope_in_variance(variance) + 1e-7).all()
