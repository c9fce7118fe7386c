"""Modes with one more example against the slow Newton, and against the equation they have to satisfy."""

import numpy as np
import pytest
from scipy.special import expit

from al_questioner.concepts.laplace.mode_shift import find_shift

TOLERANCE = 1e-7
"""Standard deviations to which modes are searched for here."""


def shifted(case, steps=None, targets=(0.0, 1.0)):
    """The shift for every point as each target: hypotheses are all points as the first target, then as the second."""
    k = case.cross.shape[1]
    both = np.tile(np.arange(k), len(targets))
    arguments = (
        case.posterior,
        case.marginals.solved[:, :, both].transpose(0, 2, 1),
        (case.amplitude - case.marginals.explained)[:, both],
        case.marginals.mean[:, both],
        np.broadcast_to(np.repeat(targets, k), (len(case.targets), len(both))),
    )
    return find_shift(*arguments, TOLERANCE) if steps is None else find_shift(*arguments, TOLERANCE, steps)


def found_modes(case, shift):
    """(|Y|, h, n + 1) latent values of the old examples and the new one."""
    old = case.posterior.modes[:, None] + shift.change / case.posterior.root[:, None]
    return np.concatenate([old, shift.latent[:, :, None]], axis=2)


def hypotheses(case):
    """Of each symbol and hypothesis: their indices, the enlarged kernel matrix and the enlarged targets."""
    k = case.cross.shape[1]
    for y in range(len(case.targets)):
        for h in range(2 * k):
            yield y, h, *case.with_one_more(h % k, float(h >= k), y)


def distance(case, difference, curvature, kernel):
    """Return the length of a difference of latent values in standard deviations of the posterior with a curvature.

    The kernel matrix may be singular, so the root of the covariance is inverted where it has one.
    """
    covariance = case.covariance(curvature, kernel)
    values, vectors = np.linalg.eigh((covariance + covariance.T) / 2)
    keep = values > 1e-9 * values.max()
    return np.sqrt(np.sum((vectors[:, keep].T @ difference) ** 2 / values[keep]))


@pytest.mark.parametrize('duplicates', [False, True])
@pytest.mark.parametrize('amplitude', [1.0, 4.0, 25.0, 100.0, 300.0])
@pytest.mark.parametrize('n', [1, 8, 40])
def test_every_mode_is_found_and_satisfies_its_own_equation(problem, n, amplitude, duplicates):
    """F' = K' (y' - p(f')) for the enlarged problem; a hypothesis that is not found would cost a fit."""
    case = problem(n + 7, n, amplitude, duplicates=duplicates)
    shift = shifted(case)
    modes = found_modes(case, shift)
    for y, h, kernel, targets in hypotheses(case):
        expected = kernel @ (targets - expit(modes[y, h]))
        np.testing.assert_allclose(modes[y, h], expected, rtol=0, atol=1e-6 * max(1, amplitude))
        np.testing.assert_allclose(modes[y, h], case.mode(kernel, targets), rtol=0, atol=1e-6)
    assert (shift.error <= TOLERANCE).all()


@pytest.mark.parametrize('steps', [1, 2, 4, None])
@pytest.mark.parametrize('amplitude', [1.0, 4.0, 25.0, 100.0, 300.0])
def test_error_bound_covers_the_distance_from_the_true_mode(problem, curvature, amplitude, steps):
    """A bound that is too small lets wrong answers pass.

    It holds where the curvatures hardly differ between the mode that was found and the true one, as they do for errors
    that are small beside 1 / sqrt(amplitude). Where the search has been cut short, nothing wrong is called right.
    """
    checked = 0
    for seed in range(3):
        case = problem(seed, 3 + 6 * seed, amplitude, duplicates=seed == 1)
        shift = shifted(case, steps)
        modes = found_modes(case, shift)
        for y, h, kernel, targets in hypotheses(case):
            mode = case.mode(kernel, targets)
            # The equation's own rounding, and that of the true mode.
            found = distance(case, modes[y, h] - mode, curvature(mode), kernel) - 1e-6
            if shift.error[y, h] * np.sqrt(amplitude) < 0.1:
                checked += 1
                assert found <= 1.1 * shift.error[y, h]
            elif found > 1e-3:
                assert shift.error[y, h] > 1e-3
    assert checked > (0 if steps is None or steps > 1 else -1)


def test_what_has_not_converged_says_so(problem):
    """Cut off after the first step, the answers are wrong, and none may claim to be right."""
    case = problem(11, 30, 100.0)
    shift = shifted(case, steps=1)
    modes = found_modes(case, shift)
    wrong = 0
    for y, h, kernel, targets in hypotheses(case):
        if np.abs(modes[y, h] - case.mode(kernel, targets)).max() > 1e-3:
            wrong += 1
            assert shift.error[y, h] > 1e-4
    assert wrong > 5


def test_attributes_belong_to_one_another(problem, curvature):
    """Pull, bend and relative change are those of the modes that are returned."""
    case = problem(5, 12, 4.0)
    shift = shifted(case)
    modes = found_modes(case, shift)
    targets = np.repeat([0.0, 1.0], 4)
    np.testing.assert_allclose(shift.pull, targets - expit(modes[:, :, -1]), atol=1e-12)
    before = curvature(case.posterior.modes)[:, None]
    after = curvature(modes[:, :, :-1])
    np.testing.assert_allclose(shift.relative, after / before - 1, atol=1e-8)
    # The gradient's change beyond the linear: p(f + g) - p(f) - W g, over W^1/2.
    gain = expit(modes[:, :, :-1]) - expit(case.posterior.modes)[:, None]
    bend = gain / case.posterior.root[:, None] - shift.change
    np.testing.assert_allclose(shift.bend, bend, atol=1e-7)


def test_targets_may_differ_between_the_classifiers(problem):
    """As in a fit after one more label: each classifier has its own target for the one new example."""
    case = problem(6, 9, 4.0, k=1)
    each = np.array([[1.0], [0.0], [1.0]])
    new = case.marginals.solved.transpose(0, 2, 1)
    variance = case.amplitude - case.marginals.explained
    shift = find_shift(case.posterior, new, variance, case.marginals.mean, each, TOLERANCE)
    modes = found_modes(case, shift)
    for y, target in enumerate(each[:, 0]):
        np.testing.assert_allclose(modes[y, 0], case.mode(*case.with_one_more(0, target, y)), rtol=0, atol=1e-6)


def test_the_first_example_of_all(problem):
    """Without old examples the new one's own equation f = amplitude (y - p(f)) is all there is."""
    for amplitude in (1.0, 4.0, 25.0, 100.0):
        shift = shifted(problem(0, 0, amplitude))
        assert shift.change.shape == (3, 8, 0)
        expected = amplitude * (np.repeat([0.0, 1.0], 4) - expit(shift.latent))
        np.testing.assert_allclose(shift.latent, expected, rtol=0, atol=1e-7)
