"""The balance of the classes by itself; in the classifiers it is tested with these."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.concepts.class_balance import balance_degrees, largest_slope

COUNTS = st.lists(st.integers(0, 200), min_size=2, max_size=6)


@given(COUNTS, st.floats(0, 1), st.integers(0, 2**32 - 1))
def test_no_error_grows_by_more_than_the_bound(counts, class_balance, seed):
    """The look-ahead is told to err by less, so that what is balanced errs by no more than it may."""
    given_counts = np.array(counts, dtype=float)
    degrees = np.random.default_rng(seed).uniform(1e-6, 1 - 1e-6, size=(50, len(counts)))
    step = 1e-7
    lower, upper = (balance_degrees(degrees + sign * step, given_counts, class_balance) for sign in (-1, 1))
    assert ((upper - lower) / (2 * step)).max() <= largest_slope(given_counts, class_balance) * (1 + 1e-4)


def test_the_bound_is_reached_at_the_ends():
    """A looser one would cost the look-ahead steps for nothing."""
    counts, step = np.array([0.0, 30.0]), 1e-9
    slopes = [
        (balance_degrees(np.array([x + step]), counts, 0.5) - balance_degrees(np.array([x]), counts, 0.5)) / step
        for x in (0.0, 1 - 2 * step)
    ]
    np.testing.assert_allclose(np.max(slopes), largest_slope(counts, 0.5), rtol=1e-3)
