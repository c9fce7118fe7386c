"""The tests of the paper against scipy, hand-solved cases and brute force."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import mannwhitneyu, wilcoxon

from al_questioner.experiments.statistics import (
    best_of,
    compare,
    control_test,
    exceeds,
    holm,
    mean_and_deviation,
    mean_and_error,
    paired_p,
    superiority,
    superiority_interval,
    u_test,
)

FIRST = np.array([0.9, 0.8, 0.7, 0.85, 0.95])
OTHER = np.array([0.6, 0.5, 0.75, 0.55, 0.65])


def test_holm_by_hand() -> None:
    """p-values of .01, .04, .03 become 3 x .01, then 2 x .03, then the larger of that and .04."""
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1.0, 1.0]


@given(st.lists(st.floats(0, 1), min_size=1, max_size=8))
def test_holm_is_monotone_and_never_below_the_raw_p(p_values: list[float]) -> None:
    """The correction never makes a result more significant."""
    corrected = holm(p_values)
    assert all(raw <= c + 1e-12 <= 1 + 1e-9 for raw, c in zip(p_values, corrected, strict=True))
    order = np.argsort(p_values, kind='stable')
    assert all(np.diff(np.array(corrected)[order]) >= 0)


def test_the_papers_test_by_counting_all_orders() -> None:
    """Exact one-tailed p: the share of ways to split the ten numbers whose U is as large as ours."""
    values = np.concatenate([FIRST, OTHER])
    observed = sum(a > b for a in FIRST for b in OTHER)
    as_large = [
        sum(values[i] > values[j] for i in chosen for j in set(range(10)) - set(chosen)) >= observed
        for chosen in itertools.combinations(range(10), 5)
    ]
    (found,) = compare(FIRST, {'other': OTHER})
    assert found.p == pytest.approx(np.mean(as_large))
    assert found.p == pytest.approx(mannwhitneyu(FIRST, OTHER, alternative='greater').pvalue)
    assert found.superiority == pytest.approx(observed / 25) == superiority(FIRST, OTHER)
    assert found.p_paired == pytest.approx(wilcoxon(FIRST - OTHER, alternative='greater').pvalue)
    assert found.interval is not None
    low, high = found.interval
    assert low <= found.superiority <= high <= 1


def test_equal_accuracies_are_no_difference() -> None:
    """Otherwise a strategy would beat itself."""
    (found,) = compare(FIRST, {'same': FIRST.copy()})
    assert found.p_paired == 1.0
    assert found.superiority == 0.5
    assert found.p > 0.3
    assert paired_p(FIRST, FIRST + 1e-15) == 1.0


ROUNDED = [19 / 37, np.nextafter(19 / 37, 0), np.nextafter(19 / 37, 1)]
"""The same accuracy, summed in different orders."""


def test_accuracies_that_differ_by_rounding_are_equal() -> None:
    """Otherwise a strategy would beat another one by the last digit of what is the same (cf. scipy 17667)."""
    low, high = np.full(6, ROUNDED[1]), np.full(6, ROUNDED[2])
    for first, other in ((high, low), (low, high)):
        (found,) = compare(first, {'other': other})
        assert (found.superiority, found.interval, found.p_paired) == (0.5, (0.5, 0.5), 1.0)
        assert found.p == pytest.approx(mannwhitneyu(low, low, alternative='greater').pvalue)
        assert control_test(first, [], other) == pytest.approx(found.p)
        assert not exceeds(first.mean(), other.mean())
    assert best_of({'worst': 0.1, 'first': ROUNDED[1], 'second': ROUNDED[2]}) == 'first'
    assert exceeds(0.5001, 0.5)


@settings(deadline=None)
@given(st.lists(st.tuples(*[st.integers(0, 4)] * 2, *[st.integers(-1, 1)] * 2), min_size=5, max_size=9))
def test_rounding_changes_no_test(pairs: list[tuple[int, int, int, int]]) -> None:
    """Otherwise ties among others, and equal differences, would be told apart as well."""
    first, other, more, less = np.array(pairs, dtype=float).T
    resolution = np.finfo(float).eps
    exact = first / 8, other / 8
    rounded = exact[0] * (1 + more * resolution), exact[1] * (1 + less * resolution)
    for test in (u_test, paired_p, superiority):
        assert test(*rounded) == test(*exact)


def test_holm_counts_all_comparisons() -> None:
    """Otherwise three chances to win would count as one."""
    found = compare(FIRST, {'a': OTHER, 'b': OTHER, 'c': FIRST})
    assert found[0].p_holm == pytest.approx(3 * found[0].p)


@pytest.mark.parametrize('count', [1, 2, 4])
def test_few_samples_give_no_interval(count: int) -> None:
    """Otherwise a quick try would end in an error, or claim to be certain."""
    (found,) = compare(FIRST[:count], {'other': OTHER[:count]})
    assert found.interval is None
    (found,) = compare(FIRST, {'other': OTHER})
    assert found.interval is not None


def test_the_interval_of_a_share_is_that_of_the_binomial_distribution() -> None:
    """Of 5 values drawn from 5, 3 of which are above: at most 1 is with a chance of .087, none with one of .010."""
    first = np.array([1.0, 1.0, 1.0, -1.0, -1.0])
    assert superiority_interval(first, np.zeros(5), seed=0) == (0.2, 1.0)


def test_mean_and_deviation_by_hand() -> None:
    """Otherwise the tables would show another spread than they say."""
    assert mean_and_deviation(np.array([0.4, 0.6])) == '0.500 ± 0.141'
    assert mean_and_deviation(np.array([0.4])) == '0.400'


def test_standard_error_by_hand() -> None:
    """Otherwise the bands of the learning curves would be of another width."""
    mean, error = mean_and_error(np.array([[1.0, 0.0], [3.0, 0.0]]))
    np.testing.assert_allclose(mean, [2, 0])
    np.testing.assert_allclose(error, [1, 0])
    assert mean_and_error(np.ones((1, 3)))[1].tolist() == [0, 0, 0]
