"""The seven decision features of the paper, as pure functions with values in [0, 1].

`q` is always (..., |X|, |Y|), the classifiers' q_y(x); leading axes are independent states, so that all outcomes of a
look-ahead are evaluated at once. Conditional distributions are normalised as in docs/explanation/method.md.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from al_questioner.support.arrays import Array


def symbol_given_object(q: Array) -> Array:
    """p(y|x), (..., |X|, |Y|): sums to 1 over the symbols."""
    p: Array = q / q.sum(axis=-1, keepdims=True)
    return p


def object_given_symbol(q: Array) -> Array:
    """p(x|y), (..., |X|, |Y|): sums to 1 over the objects."""
    p: Array = q / q.sum(axis=-2, keepdims=True)
    return p


def prediction_entropy(q: Array) -> Array:
    """Entropy of p(y|x) in nats, (..., |X|): the uncertainty that u_sampling asks about (section 2.1.1)."""
    p = symbol_given_object(q)
    entropy: Array = -(p * np.log(p)).sum(axis=-1)
    return entropy


def discriminability(q: Array) -> Array:
    """Average classifier discriminability (...): the range of q_y over the objects, mean over the symbols."""
    span: Array = q.max(axis=-2) - q.min(axis=-2)
    return np.asarray(span.mean(axis=-1))


def class_uniformity(positives: ArrayLike) -> Array:
    """Class distribution uniformity (...) of (..., |Y|) numbers of positive examples; 0 if there are none."""
    counts = np.asarray(positives, dtype=np.float64)
    largest = counts.max(axis=-1)
    return np.asarray(counts.min(axis=-1) / np.maximum(largest, 1))


def instance_variation(q: Array) -> Array:
    """Relative standard deviation of p(x|y), mean over the symbols (...), equation 3 of the paper.

    Divided by its largest possible value sqrt(|X| - 1), reached when one object has all the probability; 0 for a
    single object, which cannot vary.
    """
    n_objects = q.shape[-2]
    if n_objects == 1:
        return np.zeros(q.shape[:-2])
    p = object_given_symbol(q)
    mean = p.mean(axis=-2, keepdims=True)
    relative = np.sqrt(((p - mean) ** 2).mean(axis=-2)) / mean[..., 0, :]
    return np.asarray(np.mean(relative / np.sqrt(n_objects - 1), axis=-1))


def prediction_margin(q: Array) -> Array:
    """Lead of the most over the second most probable symbol, mean over the objects (...), equation 4; |Y| >= 2."""
    best = np.partition(symbol_given_object(q), -2, axis=-1)
    return np.asarray(np.mean(best[..., -1] - best[..., -2], axis=-1))


def budget_consumption(spent: ArrayLike, budget: float) -> Array:
    """Share of the budget that is spent; a budget of 0 is spent from the start."""
    used = np.asarray(spent, dtype=np.float64)
    return np.minimum(1.0, used / budget) if budget > 0 else np.ones_like(used)


def remaining_time(turns_left: ArrayLike, turns: int) -> Array:
    """Share of the turns that are left."""
    return np.asarray(turns_left, dtype=np.float64) / turns


def non_query_time(consecutive_turns: ArrayLike, window: int) -> Array:
    """Share of the window that has passed since the last query, at most 1."""
    return np.minimum(1.0, np.asarray(consecutive_turns, dtype=np.float64) / window)
