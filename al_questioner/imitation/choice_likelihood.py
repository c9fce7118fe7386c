"""The expert's choices as those of a softmax over the candidates: stepwise maximum likelihood, needing no simulator.

p(a|s, w) = exp(w . E[phi|a]) / sum_b exp(w . E[phi|b]). Its negative logarithm is convex in w
(docs/explanation/imitation.md).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import logsumexp

from al_questioner.domain import InputError
from al_questioner.imitation.demonstration import Demonstration, Step, all_steps, feature_scale
from al_questioner.imitation.settings import RIDGE
from al_questioner.support.arrays import Array


def balance_kinds(steps: Sequence[Step]) -> Array:
    """Weigh the N steps, with mean 1, so that every kind of query, asking nothing included, counts the same in total.

    Without it the most frequent choice, to ask nothing, would outweigh the one feature subset query of an episode.
    """
    counts = Counter(step.kind for step in steps)
    return np.array([len(steps) / (len(counts) * counts[step.kind]) for step in steps])


def negative_log_likelihood(
    weights: Array, contrasts: Sequence[Array], importance: Array, ridge: float = 0.0
) -> tuple[float, Array]:
    """Mean over the steps of -log p(chosen), and its gradient.

    Args:
        weights: (F,) w.
        contrasts: per step, (C, F) features of the candidates minus those of the chosen one.
        importance: (N,) of each step.
        ridge: adds ridge/2 |w|^2.

    Returns:
        The value, and (F,) its gradient: per step, the expected contrast under p.
    """
    value, gradient = 0.0, np.zeros_like(weights)
    for difference, factor in zip(contrasts, importance, strict=True):
        utility = difference @ weights
        total = logsumexp(utility)
        value += factor * total
        gradient += factor * (np.exp(utility - total) @ difference)
    n = len(contrasts)
    return float(value / n + 0.5 * ridge * weights @ weights), gradient / n + ridge * weights


def fit_choices(
    demonstrations: Sequence[Demonstration], importance: NDArray[np.float64] | None = None, ridge: float = RIDGE.default
) -> Array:
    """Find the (F,) weights under which the expert's choices are most probable.

    By default every kind of query matters the same; otherwise each step has its importance, (N,).

    Raises:
        InputError: no step, or none with more than one candidate.
    """
    steps = list(all_steps(demonstrations))
    if not any(len(step.actions) > 1 for step in steps):
        raise InputError('the demonstrations hold no choice: in no turn was there more than one candidate')
    scale = feature_scale(demonstrations)
    varies = scale > 0
    contrasts = [step.contrasts[:, varies] / scale[varies] for step in steps]
    found = minimize(
        negative_log_likelihood,
        np.zeros(int(varies.sum())),
        args=(contrasts, balance_kinds(steps) if importance is None else importance, ridge),
        jac=True,
        method='BFGS',
    )
    weights = np.zeros(len(scale))
    weights[varies] = found.x / scale[varies]
    return weights


def fit_temperature(weights: Array, steps: Sequence[Step]) -> float:
    """Factor by which weights whose scale means nothing make the steps most probable, in [0, 1e6].

    It makes the likelihoods of weights comparable that are meant for the best candidate and not for a softmax.
    """
    contrasts = [(step.contrasts @ weights)[:, None] for step in steps]
    unit = float(np.sqrt(np.mean(np.concatenate(contrasts) ** 2))) or 1.0
    found = minimize(
        negative_log_likelihood,
        np.ones(1),
        args=([contrast / unit for contrast in contrasts], np.ones(len(steps))),
        jac=True,
        method='L-BFGS-B',
        bounds=[(0.0, 1e6 * unit)],
    )
    return float(found.x[0] / unit)
