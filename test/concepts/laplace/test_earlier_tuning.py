"""The marginal likelihood against independent implementations, and what may become of a kernel."""

import numpy as np
import pytest
from scipy.spatial.distance import cdist
from sklearn.gaussian_process import GaussianProcessClassifier
from sklearn.gaussian_process.kernels import RBF, ConstantKernel

from al_questioner.concepts import ConceptModels, Kernel
from al_questioner.concepts.laplace.earlier_tuning import (
    AMPLITUDE_FACTOR,
    LENGTH_SCALE_FACTOR,
    log_marginal_likelihood,
    tuned_kernel,
)


def random_problem(seed, n_classes=3):
    """Points, targets of which each row has both classes, and a kernel."""
    rng = np.random.default_rng(seed)
    n, m = int(rng.integers(4, 30)), int(rng.integers(1, 8))
    points = rng.normal(size=(n, m))
    targets = (rng.random((n_classes, n)) < 0.3).astype(float)
    targets[:, 0], targets[:, 1] = 0, 1
    return points, targets, Kernel(float(rng.uniform(0.5, 30)), float(rng.uniform(0.3, 3) * np.sqrt(m)))


def squared(points):
    return cdist(points, points, 'sqeuclidean')


def central_differences(distances, targets, kernel, step=1e-4):
    def value(log_amplitude, log_length_scale):
        moved = Kernel(kernel.amplitude * np.exp(log_amplitude), kernel.length_scale * np.exp(log_length_scale))
        return log_marginal_likelihood(distances, targets, moved)[0]

    return [
        (value(step, 0) - value(-step, 0)) / (2 * step),
        (value(0, step) - value(0, -step)) / (2 * step),
    ]


@pytest.mark.parametrize('seed', range(20))
def test_value_and_gradient_equal_scikit_learn(seed):
    """Otherwise the kernel would be tuned to another quantity than the evidence of these classifiers."""
    points, targets, kernel = random_problem(seed)
    theta = np.log([kernel.amplitude, kernel.length_scale])
    covariance = ConstantKernel(kernel.amplitude) * RBF(kernel.length_scale)
    value, gradient = 0.0, np.zeros(2)
    for row in targets:
        classifier = GaussianProcessClassifier(covariance, optimizer=None).fit(points, row)
        evidence, slope = classifier.log_marginal_likelihood(theta, eval_gradient=True)
        value, gradient = value + evidence, gradient + slope
    ours = log_marginal_likelihood(squared(points), targets, kernel)
    assert ours[0] == pytest.approx(value, abs=1e-6)
    # scikit-learn stops when its value moves by less than 1e-10, its mode then by some 1e-5.
    np.testing.assert_allclose(ours[1], gradient, rtol=0, atol=1e-4)


@pytest.mark.parametrize('duplicates', [False, True])
@pytest.mark.parametrize('one_class', [False, True])
def test_gradient_equals_finite_differences(one_class, duplicates):
    """Otherwise the search would stop short; scikit-learn can say nothing on one class."""
    for seed in range(10):
        points, targets, kernel = random_problem(seed)
        if one_class:
            targets[:] = [[1], [0], [0]]
        if duplicates:
            points[::2] = points[0]
        distances = squared(points)
        gradient = log_marginal_likelihood(distances, targets, kernel)[1]
        np.testing.assert_allclose(gradient, central_differences(distances, targets, kernel), rtol=1e-5, atol=1e-6)


def test_value_of_one_example_by_hand():
    """One positive: log q = -f^2 / (2 a) + log p(f) - log(1 + a p (1 - p)) / 2, at the mode f (R&W equation 3.32)."""
    amplitude = 4.0
    f = np.linspace(0, 4, 4_000_001)
    mode = f[np.argmax(-(f**2) / (2 * amplitude) - np.logaddexp(0, -f))]
    p = 1 / (1 + np.exp(-mode))
    expected = -(mode**2) / (2 * amplitude) + np.log(p) - 0.5 * np.log1p(amplitude * p * (1 - p))
    value, gradient = log_marginal_likelihood(np.zeros((1, 1)), np.array([[1.0]]), Kernel(amplitude, 1.0))
    assert value == pytest.approx(expected, abs=1e-6)
    assert gradient[1] == 0, 'a single point knows no distance'


def test_tuning_raises_evidence_times_prior():
    """Otherwise the option would make the models worse by its own measure."""
    for seed in range(10):
        points, targets, _ = random_problem(seed)
        configured = Kernel(4.0, float(np.sqrt(points.shape[1])))
        distances = squared(points)
        tuned = tuned_kernel(points, targets, configured)
        before = log_marginal_likelihood(distances, targets, configured)[0]
        assert log_marginal_likelihood(distances, targets, tuned)[0] >= before


def test_tuning_finds_back_a_kernel_that_made_the_labels():
    """With many labels the prior must give way."""
    rng = np.random.default_rng(0)
    points = rng.uniform(-3, 3, size=(300, 1))
    truth = Kernel(14.0, 0.6)
    covariance = truth.amplitude * np.exp(-0.5 * squared(points) / truth.length_scale**2) + 1e-8 * np.eye(300)
    latent = np.linalg.cholesky(covariance) @ rng.normal(size=(300, 4))
    targets = (rng.random((4, 300)) < 1 / (1 + np.exp(-latent.T))).astype(float)
    tuned = tuned_kernel(points, targets, Kernel(4.0, 1.0))
    assert tuned.length_scale == pytest.approx(truth.length_scale, rel=0.25)
    assert tuned.amplitude == pytest.approx(truth.amplitude, rel=0.5)


@pytest.mark.parametrize('configured', [Kernel(4.0, 1.0), Kernel(100.0, 0.1), Kernel(0.01, 30.0)])
@pytest.mark.parametrize('n', [1, 2, 5, 100])
@pytest.mark.parametrize('kind', ['one class', 'noise', 'separated', 'one place'])
def test_bounds_hold(kind, n, configured):
    """Otherwise a kernel would run off, and with it every probability to 0, 1/2 or 1."""
    rng = np.random.default_rng(n)
    points = rng.normal(size=(n, 2))
    targets = np.zeros((2, n))
    if kind == 'one class':
        targets[0] = 1
    elif kind == 'noise':
        targets = (rng.random((2, n)) < 0.5).astype(float)
    elif kind == 'separated':
        targets[0, points[:, 0] > 0] = 1
        points[points[:, 0] > 0, 0] += 50
    else:
        points[:] = 0
        targets[0, ::2] = 1
    tuned = tuned_kernel(points, targets, configured)
    tolerance = 1 + 1e-12
    assert 1 / (AMPLITUDE_FACTOR * tolerance) <= tuned.amplitude / configured.amplitude <= AMPLITUDE_FACTOR * tolerance
    ratio = tuned.length_scale / configured.length_scale
    assert 1 / (LENGTH_SCALE_FACTOR * tolerance) <= ratio <= LENGTH_SCALE_FACTOR * tolerance


@pytest.mark.parametrize('n', [1, 3, 30])
def test_one_class_leaves_what_is_far_away_open(n):
    """Otherwise after a few labels of one kind the robot would be certain of everything, and ask no more."""
    rng = np.random.default_rng(n)
    points = rng.normal(size=(n, 4))
    targets = np.stack([np.ones(n), np.zeros(n)])
    tuned = tuned_kernel(points, targets, Kernel(4.0, 2.0))
    models = ConceptModels(('a', 'b'), tuned.amplitude, tuned.length_scale).fit(points, ['a'] * n)
    q = models.predict_proba(np.vstack([points[:1], 20 + points[:1]]))
    assert 0.01 < q[0, 1] < q[1, 1] < 0.55
    assert q[1, 0] < 0.6


def test_nothing_known_leaves_the_configured_kernel():
    assert tuned_kernel(np.empty((0, 3)), np.empty((2, 0)), Kernel(4.0, 2.0)) == Kernel(4.0, 2.0)


def test_order_of_examples_and_classes_does_not_matter():
    """Otherwise two robots that were told the same would believe different things."""
    points, targets, _ = random_problem(3)
    rng = np.random.default_rng(1)
    examples, classes = rng.permutation(len(points)), rng.permutation(len(targets))
    plain = tuned_kernel(points, targets, Kernel(4.0, 2.0))
    shuffled = tuned_kernel(points[examples], targets[classes][:, examples], Kernel(4.0, 2.0))
    assert shuffled.amplitude == pytest.approx(plain.amplitude, rel=1e-4)
    assert shuffled.length_scale == pytest.approx(plain.length_scale, rel=1e-4)
