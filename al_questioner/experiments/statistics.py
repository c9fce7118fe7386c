"""Tests whether one strategy is better than others: the paper's test and others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import mannwhitneyu, wilcoxon

from al_questioner.support.arrays import Array

RESAMPLES = 2000
ROUNDING = 1e-9
"""Largest difference of accuracies, or of their means, that comes from rounding: these count as equal."""
LEAST_FOR_INTERVAL = 5
"""Smallest number of samples for resampling; two samples that differ would give the interval [1, 1]."""


@dataclass(frozen=True)
class Comparison:
    """Comparison of the final accuracies of one strategy with those of another, over the samples.

    Attributes:
        other: the strategy it is compared with.
        mean, other_mean: mean accuracies.
        p: p-value of the one-tailed Mann-Whitney U test that the first is larger: the paper's test.
        p_holm: the same, corrected by Holm's method for the number of comparisons.
        superiority: probability that a sample of the first is above one of the other, ties counting half: U / (n m).
        interval: its 95 % bootstrap interval; None with too few samples.
        p_paired: p-value of Wilcoxon's one-tailed signed-rank test over the samples, which both strategies share.
    """

    other: str
    mean: float
    other_mean: float
    p: float
    p_holm: float
    superiority: float
    interval: tuple[float, float] | None
    p_paired: float


def compare(first: Array, others: Mapping[str, Array], seed: int = 0) -> list[Comparison]:
    """Compare a strategy with each of others.

    Args:
        first: (n,) accuracies, by sample.
        others: (n,) accuracies of each other strategy, in the same order of samples.
        seed: seed of the bootstrap.
    """
    tests = {name: u_test(first, other) for name, other in others.items()}
    corrected = holm([p for _, p in tests.values()])
    found = []
    for (name, (statistic, p)), p_holm in zip(tests.items(), corrected, strict=True):
        other = others[name]
        found.append(
            Comparison(
                other=name,
                mean=float(np.mean(first)),
                other_mean=float(np.mean(other)),
                p=p,
                p_holm=p_holm,
                superiority=statistic / (len(first) * len(other)),
                interval=superiority_interval(first, other, seed),
                p_paired=paired_p(first, other),
            )
        )
    return found


def u_test(first: Array, other: Array) -> tuple[float, float]:
    """Return statistic and p-value of the one-tailed Mann-Whitney U test that the first is larger."""
    pooled = without_rounding(np.concatenate([first, other]))
    test = mannwhitneyu(pooled[: len(first)], pooled[len(first) :], alternative='greater')
    return float(test.statistic), float(test.pvalue)


def without_rounding(values: Array) -> Array:
    """Return (n,) values in which those that differ only by rounding are replaced by the smallest of them."""
    order = np.argsort(values, kind='stable')
    ordered = values[order]
    is_new = np.diff(ordered, prepend=-np.inf) > ROUNDING
    equal = np.empty_like(ordered)
    equal[order] = ordered[is_new][np.cumsum(is_new) - 1]
    return equal


def exceeds(first: float, other: float) -> bool:
    """Return whether the first number is larger by more than rounding."""
    return first - other > ROUNDING


def best_of(means: Mapping[str, float]) -> str:
    """Return the name of the largest value; the first of those that differ from it only by rounding."""
    largest = max(means.values())
    return next(name for name, mean in means.items() if not exceeds(largest, mean))


def p_text(p: float) -> str:
    """Return a p-value for readers: 'p = 0.012', 'p < 0.001'."""
    return 'p < 0.001' if p < 0.001 else f'p = {p:.3f}'


def control_test(control: Array, others: Sequence[Array], first: Array) -> float:
    """Return p of the one-tailed Mann-Whitney U test that a control is above a strategy, with Holm's correction.

    The correction is for the number of controls.

    Args:
        control: (n,) accuracies.
        others: accuracies of the other controls.
        first: accuracies of the strategy.
    """
    return holm([u_test(values, first)[1] for values in (control, *others)])[0]


def holm(p_values: Sequence[float]) -> list[float]:
    """Return p-values with Holm's step-down correction: the i-th smallest of k times k - i + 1, made monotone.

    They are at most 1.
    """
    count = len(p_values)
    corrected, largest = [0.0] * count, 0.0
    for rank, index in enumerate(np.argsort(p_values, kind='stable')):
        largest = max(largest, min(1.0, (count - rank) * p_values[index]))
        corrected[int(index)] = largest
    return corrected


def paired_p(first: Array, other: Array) -> float:
    """Return p of Wilcoxon's one-tailed signed-rank test that the first is larger; 1 if no pair differs."""
    difference = first - other
    # Round by size, because the test ranks the sizes.
    sizes = without_rounding(np.append(np.abs(difference), 0.0))[:-1]
    signed = np.sign(difference) * sizes
    return float(wilcoxon(signed, alternative='greater').pvalue) if signed.any() else 1.0


def superiority(first: Array, other: Array) -> Array:
    """Return (...) probability that one of (..., n) first is above one of (..., m) other, ties counting half."""
    difference = first[..., :, None] - other[..., None, :]
    return np.asarray(np.mean((difference > ROUNDING) + 0.5 * (np.abs(difference) <= ROUNDING), axis=(-2, -1)))


def superiority_interval(first: Array, other: Array, seed: int) -> tuple[float, float] | None:
    """Return the 95 % percentile bootstrap interval of `superiority`; None below `LEAST_FOR_INTERVAL` samples."""
    if min(len(first), len(other)) < LEAST_FOR_INTERVAL:
        return None
    rng = np.random.default_rng(seed)
    resampled = [values[rng.integers(0, len(values), (RESAMPLES, len(values)))] for values in (first, other)]
    low, high = np.percentile(superiority(*resampled), (2.5, 97.5))
    return float(low), float(high)


def mean_and_deviation(values: Array) -> str:
    """Return (n,) values for readers, '0.512 ± 0.034': mean and standard deviation; for a single one just the value."""
    mean = f'{values.mean():.3f}'
    return f'{mean} ± {values.std(ddof=1):.3f}' if len(values) > 1 else mean


def mean_and_error(values: Array) -> tuple[Array, Array]:
    """Return (T,) mean and standard error over the samples of (n, T) values; an error of 0 for a single sample."""
    mean = values.mean(axis=0)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.zeros_like(mean)
    return mean, error
