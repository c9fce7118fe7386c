"""Whole numbers from shares."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from al_questioner.simulation.kitchen.pool import apportion


@given(st.lists(st.integers(1, 50), min_size=1, max_size=6), st.integers(0, 500))
def test_apportionment_sums_up_and_stays_within_one_of_the_share(weights: list[int], total: int) -> None:
    shares = {str(i): weight / sum(weights) for i, weight in enumerate(weights)}
    counts = apportion(shares, total)
    assert sum(counts.values()) == total
    assert all(abs(counts[name] - share * total) < 1 + 1e-6 for name, share in shares.items())


def test_apportionment_by_hand() -> None:
    """Hamilton's method: 4.5, 3 and 1.5 of 9 become 5, 3 and 1; the first of two equal remainders wins."""
    assert apportion({'a': 0.5, 'b': 1 / 3, 'c': 1 / 6}, 9) == {'a': 5, 'b': 3, 'c': 1}
