"""Maximum entropy inverse reinforcement learning: weights whose rollouts have the expert's feature counts (equation 6).

The gradient of the maximum entropy loss is the gap between the expert's counts and those of the rollouts (equation 7);
its zero is sought. The policy is a softmax over one-step expected utility, which does not foresee that a query now may
be missed later, so that steps along the gap itself do not lead there. They are preconditioned with the Jacobian of the
counts, estimated from the same rollouts, see docs/explanation/imitation.md.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from al_questioner.imitation.demonstration import Demonstration
from al_questioner.imitation.identifiability import Identifiability
from al_questioner.imitation.rollouts import Rollout, Simulator
from al_questioner.imitation.settings import MatchingSettings
from al_questioner.support.arrays import Array

DAMPING = 0.3
"""Added to the squared singular values of the Jacobian: where the rollouts tell little, steps are short."""

STEP = 0.5
"""Share of the damped Gauss-Newton step that is taken."""
LONGEST_STEP = 1.0
"""Length, in units of the features' scale, to which the step is cut before the share of it is taken."""

MEMORY = 0.9
"""Weight of the earlier iterations in the running mean of the Jacobian."""

FIRST_ROLLOUTS = 8
"""Times as many rollouts in the first iteration: a poor first Jacobian leads to where there is nothing to learn."""

WINDOW = 10
"""Iterations over which weights and gaps are averaged: single ones are as noisy as their few rollouts."""

TOO_LARGE = 2.0
"""Times the smallest validation gap on the way: weights with a larger one do not hold what they were kept for."""


@dataclass(frozen=True, eq=False)
class Iteration:
    """One iteration.

    Attributes:
        weights: (F,) that were rolled out.
        gap: (F,) expert's minus learner's counts, in units of the features' scale, over the training demonstrations.
        validation_gap: the same over the validation demonstrations.
    """

    weights: Array
    gap: Array
    validation_gap: Array


@dataclass(frozen=True, eq=False)
class Matching:
    """Result of a matching.

    Attributes:
        weights: (F,) mean over the window of iterations whose validation gap is smallest.
        kept: index of the last iteration of that window.
        gap: (F,) over the training demonstrations, of new rollouts with the weights.
        validation_gap: (F,) the same over the validation demonstrations; that of training if there are none.
    """

    weights: Array
    iterations: tuple[Iteration, ...]
    kept: int
    gap: Array
    validation_gap: Array

    @cached_property
    def validation_gaps(self) -> dict[str, float]:
        """Length of the gap over the validation demonstrations: before, after, and the smallest mean of a window."""
        return {
            'before': float(np.linalg.norm(self.iterations[0].validation_gap)),
            'after': float(np.linalg.norm(self.validation_gap)),
            'smallest': float(mean_gaps(self.iterations, self.kept)[1]),
        }

    @property
    def validation_failed(self) -> bool:
        """True if the validation gap of the weights is as large as before, or much larger than it was on the way."""
        gaps = self.validation_gaps
        return gaps['after'] > min(gaps['before'], TOO_LARGE * gaps['smallest'])


def match_features(
    training: Sequence[Demonstration],
    validation: Sequence[Demonstration],
    settings: MatchingSettings,
    free: Identifiability,
    watch: Callable[[int, Iteration], None] | None = None,
) -> Matching:
    """Find the weights with which rollouts have the feature counts of the training demonstrations.

    The validation demonstrations choose among the iterations; if there are none, the training ones do. After each
    iteration `watch` is called with its number, from 1.

    Raises:
        InputError: a demonstration took place in no simulated world.
    """
    scale, varies = free.scale, free.scale > 0
    scaled, jacobian = np.zeros(len(scale)), None
    iterations: list[Iteration] = []
    smallest, fell_at = np.array([np.inf, np.inf]), 0
    with Simulator([*training, *validation], settings.jobs) as simulator:
        while len(iterations) < settings.iterations and len(iterations) - fell_at <= settings.patience:
            weights = np.divide(scaled, scale, out=np.zeros_like(scaled), where=varies)
            count = settings.rollouts * (1 if iterations else FIRST_ROLLOUTS)
            rollouts = simulator.roll_out(weights, count, f'{settings.seed}/{len(iterations)}')
            gap = _gap(training, rollouts[: len(training)], scale)
            held_out = _gap(validation, rollouts[len(training) :], scale) if validation else gap
            iterations.append(Iteration(weights, gap, held_out))
            if watch is not None:
                watch(len(iterations), iterations[-1])
            if len(iterations) >= WINDOW:
                smoothed = mean_gaps(iterations, len(iterations) - 1)
                if (smoothed < smallest).any():
                    fell_at = len(iterations)
                smallest = np.minimum(smallest, smoothed)
            estimate = jacobian_of_counts(rollouts, scale)
            jacobian = estimate if jacobian is None else MEMORY * jacobian + (1 - MEMORY) * estimate
            scaled = scaled + gauss_newton_step(jacobian, gap, varies)
            scaled -= free.null_space.T @ (free.null_space @ scaled)
        kept = best_window(iterations)
        mean = np.asarray(np.mean([iteration.weights for iteration in window_of(iterations, kept)], axis=0))
        rollouts = simulator.roll_out(mean, settings.rollouts * FIRST_ROLLOUTS, f'{settings.seed}/kept')
        gap = _gap(training, rollouts[: len(training)], scale)
        held_out = _gap(validation, rollouts[len(training) :], scale) if validation else gap
        return Matching(mean, tuple(iterations), kept, gap, held_out)


def best_window(iterations: Sequence[Iteration]) -> int:
    """Index of the last iteration of the window with the smallest mean validation gap; a full one if there are any."""
    ends = range(WINDOW - 1, len(iterations)) or range(len(iterations))
    return min(ends, key=lambda last: mean_gaps(iterations, last)[1])


def window_of(iterations: Sequence[Iteration], last: int) -> Sequence[Iteration]:
    """Return the window of iterations that ends with this one."""
    return iterations[max(0, last + 1 - WINDOW) : last + 1]


def mean_gaps(iterations: Sequence[Iteration], last: int) -> Array:
    """Return the (2,) lengths of the mean training and validation gap over the window that ends with an iteration."""
    window = window_of(iterations, last)
    means = np.mean([[iteration.gap, iteration.validation_gap] for iteration in window], axis=0)
    return np.asarray(np.linalg.norm(means, axis=1))


def jacobian_of_counts(rollouts: Sequence[Sequence[Rollout]], scale: Array) -> Array:
    """Return the (F, F) derivative of the expected feature counts by the weights, both in units of the features' scale.

    By the likelihood ratio: d E[phi_t] / dw = Cov(phi_t, sum_(s <= t) d log p(a_s) / dw) over the rollouts of each
    world; what is chosen after turn t does not change the features of turn t and would add but noise.
    """
    total = np.zeros((len(scale), len(scale)))
    for of_world in rollouts:
        features = np.array([rollout.features for rollout in of_world])
        scores = np.cumsum([rollout.scores for rollout in of_world], axis=1)
        deviations = features - features.mean(axis=0)
        total += np.einsum('rtf,rtg->fg', deviations, scores) / ((len(of_world) - 1) * features.shape[1])
    unit = np.divide(1.0, scale, out=np.zeros_like(scale), where=scale > 0)
    return total / len(rollouts) * unit[:, None] * unit


def gauss_newton_step(jacobian: Array, gap: Array, varies: NDArray[np.bool_]) -> Array:
    """Return the (F,) damped Gauss-Newton step towards a gap, (F,), of zero; its length is limited.

    The Jacobian is that of `jacobian_of_counts`; features that do not vary among candidates at all are left out.
    """
    part = jacobian[np.ix_(varies, varies)]
    normal = part.T @ part + DAMPING * np.eye(len(part))
    step = np.zeros(len(gap))
    step[varies] = np.linalg.solve(normal, part.T @ gap[varies])
    length = float(np.linalg.norm(step))
    return STEP * step * min(1.0, LONGEST_STEP / length) if length > 0 else step


def _gap(demonstrations: Sequence[Demonstration], rollouts: Sequence[Sequence[Rollout]], scale: Array) -> Array:
    expert = np.mean([demonstration.feature_counts for demonstration in demonstrations], axis=0)
    learner = np.mean([np.mean([rollout.feature_counts for rollout in each], axis=0) for each in rollouts], axis=0)
    return np.asarray(np.divide(expert - learner, scale, out=np.zeros_like(scale), where=scale > 0))
