"""Whether one strategy is better than others, by the paper's test and by others beside it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu, wilcoxon

Array = NDArray[np.float64]

RESAMPLES = 2000
LEAST_FOR_INTERVAL = 5
"""Samples below which resampling them says nothing of others: two that differ would give [1, 1]."""


@dataclass(frozen=True)
class Comparison:
    """Of the accuracies of one strategy with those of another, at the end of the time, over the samples.

    Attributes:
        other: the strategy it is compared with.
        mean, other_mean: mean accuracies.
        p: of the one-tailed Mann-Whitney U test that the first is larger: the paper's test.
        p_holm: the same, corrected by Holm's method for the number of comparisons.
        superiority: probability that a sample of the first is above one of the other, ties counting half: U / (n m).
        interval: its 95 % bootstrap interval; None of too few samples.
        p_paired: of Wilcoxon's one-tailed signed-rank test over the samples, which both strategies share.
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
        seed: of the bootstrap.
    """
    tests = {name: mannwhitneyu(first, other, alternative='greater') for name, other in others.items()}
    corrected = holm([float(test.pvalue) for test in tests.values()])
    found = []
    for (name, test), p_holm in zip(tests.items(), corrected, strict=True):
        other = others[name]
        found.append(
            Comparison(
                other=name,
                mean=float(np.mean(first)),
                other_mean=float(np.mean(other)),
                p=float(test.pvalue),
                p_holm=p_holm,
                superiority=float(test.statistic) / (len(first) * len(other)),
                interval=superiority_interval(first, other, seed),
                p_paired=paired_p(first, other),
            )
        )
    return found


def p_text(p: float) -> str:
    """A p-value for readers: 'p = 0.012', 'p < 0.001'."""
    return 'p < 0.001' if p < 0.001 else f'p = {p:.3f}'


def control_test(control: Array, others: Sequence[Array], first: Array) -> float:
    """Of the one-tailed Mann-Whitney U test that a control is above a strategy, p Holm-corrected among the controls.

    Args:
        control: (n,) accuracies.
        others: of the other controls.
        first: of the strategy.
    """
    tests = [mannwhitneyu(values, first, alternative='greater').pvalue for values in (control, *others)]
    return holm([float(p) for p in tests])[0]


def holm(p_values: Sequence[float]) -> list[float]:
    """Holm's step-down correction: the i-th smallest of k times k - i + 1, made monotone, at most 1."""
    count = len(p_values)
    corrected, largest = [0.0] * count, 0.0
    for rank, index in enumerate(np.argsort(p_values, kind='stable')):
        largest = max(largest, min(1.0, (count - rank) * p_values[index]))
        corrected[int(index)] = largest
    return corrected


def paired_p(first: Array, other: Array) -> float:
    """Of Wilcoxon's one-tailed signed-rank test that the first is larger; 1 if no pair differs."""
    # Rounded, as equal accuracies that were averaged in another order are ties.
    difference = np.round(first - other, 12)
    return float(wilcoxon(difference, alternative='greater').pvalue) if difference.any() else 1.0


def superiority(first: Array, other: Array) -> Array:
    """(...) probability that one of the (..., n) first is above one of the (..., m) other, ties counting half.

    Args:
        first: samples along the last axis.
        other: samples along the last axis.
    """
    difference = first[..., :, None] - other[..., None, :]
    return np.asarray(np.mean((difference > 0) + 0.5 * (difference == 0), axis=(-2, -1)))


def superiority_interval(first: Array, other: Array, seed: int) -> tuple[float, float] | None:
    """95 % percentile bootstrap interval of `superiority`; None of fewer samples than `LEAST_FOR_INTERVAL`."""
    if min(len(first), len(other)) < LEAST_FOR_INTERVAL:
        return None
    rng = np.random.default_rng(seed)
    resampled = [values[rng.integers(0, len(values), (RESAMPLES, len(values)))] for values in (first, other)]
    low, high = np.percentile(superiority(*resampled), (2.5, 97.5))
    return float(low), float(high)


def mean_and_deviation(values: Array) -> str:
    """(n,) values for readers, '0.512 ± 0.034': mean and standard deviation; of a single one just the value."""
    mean = f'{values.mean():.3f}'
    return f'{mean} ± {values.std(ddof=1):.3f}' if len(values) > 1 else mean


def mean_and_error(values: Array) -> tuple[Array, Array]:
    """(T,) mean and standard error over the samples of (n, T) values; an error of 0 for a single sample."""
    mean = values.mean(axis=0)
    error = values.std(axis=0, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.zeros_like(mean)
    return mean, error
