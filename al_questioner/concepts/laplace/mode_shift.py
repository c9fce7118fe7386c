"""Shift of the modes when one more example is added, starting from the present posterior.

In scaled coordinates: for a function g on the n examples, the arrays hold W^1/2 g. In these the posterior covariance of
the examples is T = I - B^-1, see `Posterior`. Derived in docs/explanation/look_ahead.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.concepts.laplace.fixed_point import extrapolate
from al_questioner.concepts.laplace.posterior import Posterior
from al_questioner.support.arrays import Array

MODE_TOLERANCE = 2e-7
"""Distance from the true mode, in posterior standard deviations, at which the search for it ends."""

MOST_MODE_STEPS = 12
MOST_SITE_STEPS = 50


@dataclass(frozen=True, eq=False)
class Shift:
    """Shift of the modes when one example is added.

    Attributes:
        change: (|Y|, h, n) W^1/2 g, the change of the modes at the old examples, scaled.
        latent: (|Y|, h) mode at the new example.
        pull: (|Y|, h) rho, the gradient of the new example there.
        bend: (|Y|, h, n) W^-1/2 h, the change of the old examples' gradients beyond the linear part.
        relative: (|Y|, h, n) E = W' / W - 1, the relative change of the old examples' curvatures.
        error: (|Y|, h) bound on the distance from the true mode, in posterior standard deviations.
    """

    change: Array
    latent: Array
    pull: Array
    bend: Array
    relative: Array
    error: Array


def find_shift(
    posterior: Posterior,
    solved: Array,
    variance: Array,
    mean: Array,
    targets: Array,
    steps: int = MOST_MODE_STEPS,
    tolerance: float = MODE_TOLERANCE,
) -> Shift:
    """Return the modes of the posteriors with one more example, as a change of the present ones.

    Solves g = c rho - T h(g) for the change g of the modes at the old examples, where c is their covariance with the
    new one: a fixed point iteration that contracts by the relative change of W, accelerated by Anderson's method with
    a memory of one step (Anderson 1965).

    Args:
        posterior: posteriors without the example.
        solved: (|Y|, h, n) covariance of each new example with the old ones, scaled.
        variance: (|Y|, h) posterior variance of each new example.
        mean: (|Y|, h) posterior mean of each new example.
        targets: (h,) or (|Y|, h) 1 for a positive, 0 for a negative example.
        steps: largest number of evaluations of h.
        tolerance: error at which the search for a mode ends.
    """
    # One memory layout, so that there is one compiled version.
    targets = np.broadcast_to(targets, mean.shape)
    solved, variance, mean, targets = map(np.ascontiguousarray, (solved, variance, mean, targets))
    change, bend, relative = np.empty_like(solved), np.empty_like(solved), np.empty_like(solved)
    latent, pull, error = np.zeros_like(mean), np.empty_like(mean), np.empty_like(mean)
    for y in range(len(solved)):
        _find_shifts(
            posterior.covariance[y],
            posterior.modes[y],
            posterior.root[y],
            solved[y],
            variance[y],
            mean[y],
            targets[y],
            steps,
            tolerance,
            (change[y], latent[y], pull[y], bend[y], relative[y], error[y]),
        )
    return Shift(change, latent, pull, bend, relative, error)


@compiled
def _find_shifts(
    covariance: Array,
    modes: Array,
    root: Array,
    solved: Array,
    variance: Array,
    mean: Array,
    targets: Array,
    steps: int,
    tolerance: float,
    results: tuple[Array, ...],
) -> None:
    """Compute `find_shift` for one classifier; a hypothesis that has converged is left out of further steps."""
    change, latent, pull, bend, relative, error = results
    n_hypotheses, n = solved.shape
    p = np.empty(n)
    for i in range(n):
        p[i] = 1 / (1 + np.exp(-modes[i]))
    guess, spread = np.zeros((n_hypotheses, n)), np.zeros((n_hypotheses, n))
    image, residual = np.zeros((n_hypotheses, n)), np.zeros((n_hypotheses, n))
    squared = np.zeros(n_hypotheses)
    active = np.arange(n_hypotheses)
    for step in range(1, steps + 1):
        if step > 1:
            spread = np.dot(guess[: len(active)], covariance)
        n_left = 0
        for a in range(len(active)):
            h = active[a]
            linear_mean = mean[h]
            for i in range(n):
                linear_mean -= solved[h, i] * guess[a, i]
            latent[h] = _new_site(latent[h], linear_mean, variance[h], targets[h])
            pull[h] = targets[h] - 1 / (1 + np.exp(-latent[h]))
            length, common = 0.0, 0.0
            for i in range(n):
                change[h, i] = solved[h, i] * pull[h] - spread[a, i]
                relative[h, i] = 1 / (1 + np.exp(-modes[i] - change[h, i] / root[i]))
                bend[h, i] = (relative[h, i] - p[i]) / root[i] - change[h, i]
                difference = bend[h, i] - guess[a, i]
                length += difference * difference
                common += difference * residual[a, i]
            if step == steps or length <= tolerance * tolerance:
                lowest = 0.0
                for i in range(n):
                    relative[h, i] = relative[h, i] * (1 - relative[h, i]) / (root[i] * root[i]) - 1
                    lowest = min(lowest, relative[h, i])
                # The metrics of the old and the new posterior differ only by the change of the curvatures. The residual
                # of the new example's own equation counts as well, times the logistic function's largest slope.
                open_site = np.sqrt(variance[h]) / 4 * abs(latent[h] - linear_mean - variance[h] * pull[h])
                error[h] = (np.sqrt(length) + open_site) / (1 + lowest)
                continue
            extrapolate((guess, image, residual, squared), a, n_left, bend[h], length, common)
            active[n_left] = h
            n_left += 1
        active = active[:n_left]
        if n_left == 0:
            break


@compiled
def _new_site(latent: float, mean: float, variance: float, target: float) -> float:
    """Return the solution x of x = mean + variance (target - logistic(x)), by Newton's method from `latent`.

    A step across 0, the logistic function's point of inflection, ends at 0. From there the method approaches the
    solution from one side.
    """
    for _ in range(MOST_SITE_STEPS):
        p = float(1 / (1 + np.exp(-latent)))
        step = (latent - mean - variance * (target - p)) / (1 + variance * p * (1 - p))
        if abs(step) <= 1e-12 * (1 + abs(latent)):
            return latent - step
        latent = latent - step if latent * (latent - step) >= 0 else 0.0
    return latent
