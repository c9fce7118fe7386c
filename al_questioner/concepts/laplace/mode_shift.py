"""Shift of the modes when one more example is added, found from the present posterior.

In scaled coordinates: for a function g on the n examples, the arrays hold W^1/2 g. In these the posterior covariance of
the examples is T = I - B^-1, see `Posterior`. Derived in docs/explanation/look_ahead.md.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from al_questioner.concepts.laplace.active_set import LARGEST_PASSIVE, LOWER, SLOW, factorise, select_active, substitute
from al_questioner.concepts.laplace.compiled import compiled
from al_questioner.concepts.laplace.posterior import Posterior
from al_questioner.support.arrays import Array

MOST_MODE_STEPS = 40
MOST_SITE_STEPS = 50


@dataclass(frozen=True, eq=False)
class Shift:
    """Changes of |Y| classifiers by h hypothetical examples, each added alone.

    Attributes:
        change: (|Y|, h, n) W^1/2 g, the change of the modes at the old examples, scaled.
        latent: (|Y|, h) the new example's own mode.
        pull: (|Y|, h) rho, the gradient of the new example there.
        bend: (|Y|, h, n) W^-1/2 h, by how much the old examples' gradients change beyond the linear.
        relative: (|Y|, h, n) E = W' / W - 1, the relative change of the old examples' curvatures.
        error: (|Y|, h) bound on the distance from the true mode, in standard deviations of the new posterior.
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
    tolerance: float,
    steps: int = MOST_MODE_STEPS,
) -> Shift:
    """Find the modes of the posteriors with one more example, as a change of the present ones.

    Solves g = c rho - T h(g) for the change g of the modes at the old examples, where c is their covariance with the
    new one, by Newton's method, whose linear systems are solved on their active set and iterated on the rest along with
    Newton's own steps.

    Args:
        posterior: without the example.
        solved: (|Y|, h, n) covariance of each new example with the old ones, scaled.
        variance: (|Y|, h) posterior variance of each new example.
        mean: (|Y|, h) posterior mean of each new example.
        targets: (h,) or (|Y|, h) 1 for a positive, 0 for a negative example.
        tolerance: error at which the search for a mode ends.
        steps: most evaluations of h.
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
    """Find the shifts of one classifier; a hypothesis that has converged takes no part in further steps."""
    change, latent, pull, bend, relative, error = results
    n_hypotheses, n = solved.shape
    p = np.empty(n)
    for i in range(n):
        p[i] = 1 / (1 + np.exp(-modes[i]))
    guess, spread = np.zeros((n_hypotheses, n)), np.zeros((n_hypotheses, n))
    residual, rows, matrix, pivots = np.empty(n), np.empty(n, np.intp), np.empty((n, n)), np.empty(n, np.intp)
    step_there = np.empty(n)
    limit, before = np.full(n_hypotheses, LARGEST_PASSIVE), np.full(n_hypotheses, np.inf)
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
            there = 1 / (1 + np.exp(-latent[h]))
            pull[h] = targets[h] - there
            squared = 0.0
            for i in range(n):
                change[h, i] = solved[h, i] * pull[h] - spread[a, i]
                after = 1 / (1 + np.exp(-modes[i] - change[h, i] / root[i]))
                bend[h, i] = (after - p[i]) / root[i] - change[h, i]
                relative[h, i] = after * (1 - after) / (root[i] * root[i]) - 1
                residual[i] = bend[h, i] - guess[a, i]
                squared += residual[i] * residual[i] / (1 + relative[h, i])
            # What the new example's own equation leaves open counts as well, by the logistic function's largest slope.
            open_site = np.sqrt(variance[h]) / 4 * abs(latent[h] - linear_mean - variance[h] * pull[h])
            error[h] = np.sqrt(squared) + open_site
            if step == steps or error[h] <= tolerance:
                continue
            if error[h] > SLOW * before[h]:
                limit[h] *= LOWER
            before[h] = error[h]
            # Newton's matrix is I + E (T - coupling c c'): the new example follows the others.
            coupling = there * (1 - there) / (1 + variance[h] * there * (1 - there))
            size = select_active(covariance, relative[h], limit[h], rows)
            for x in range(size):
                step_there[x] = residual[rows[x]]
                residual[rows[x]] = 0.0
            along = 0.0
            for i in range(n):
                # The others' own rows are solved for themselves alone.
                own = covariance[i, i] - coupling * solved[h, i] * solved[h, i]
                residual[i] /= 1 + relative[h, i] * own
                along += solved[h, i] * residual[i]
            for x in range(size):
                i = rows[x]
                passive = 0.0
                for j in range(n):
                    passive += covariance[i, j] * residual[j]
                for z in range(size):
                    j = rows[z]
                    matrix[x, z] = relative[h, i] * (covariance[i, j] - coupling * solved[h, i] * solved[h, j])
                matrix[x, x] += 1
                step_there[x] -= relative[h, i] * (passive - coupling * solved[h, i] * along)
            factorise(matrix, pivots, size)
            substitute(matrix, pivots, size, step_there)
            for x in range(size):
                residual[rows[x]] = step_there[x]
            for i in range(n):
                guess[n_left, i] = guess[a, i] + residual[i]
            active[n_left] = h
            n_left += 1
        active = active[:n_left]
        if n_left == 0:
            break


@compiled
def _new_site(latent: float, mean: float, variance: float, target: float) -> float:
    """Solve x = mean + variance (target - logistic(x)) for x, by Newton's method from `latent`.

    A step across 0, the logistic function's point of inflection, ends there: from 0 the method approaches the solution
    from one side.
    """
    for _ in range(MOST_SITE_STEPS):
        p = float(1 / (1 + np.exp(-latent)))
        step = (latent - mean - variance * (target - p)) / (1 + variance * p * (1 - p))
        if abs(step) <= 1e-12 * (1 + abs(latent)):
            return latent - step
        latent = latent - step if latent * (latent - step) >= 0 else 0.0
    return latent
