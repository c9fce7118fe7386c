"""The seven decision features and the entropy, computed by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.stats import entropy

from al_questioner.questioning.strategies import decision_features as phi

OF_BELIEFS = (phi.discriminability, phi.instance_variation, phi.prediction_margin)
# Three objects (rows), two symbols.
Q = np.array([[0.8, 0.2], [0.5, 0.5], [0.2, 0.8]])

beliefs = arrays(np.float64, st.tuples(st.integers(1, 5), st.integers(2, 4)), elements=st.floats(1e-9, 1 - 1e-9))


def test_conditional_distributions():
    np.testing.assert_allclose(phi.symbol_given_object(np.array([[0.6, 0.2]])), [[0.75, 0.25]])
    np.testing.assert_allclose(phi.object_given_symbol(np.array([[0.6, 0.2], [0.2, 0.2]])), [[0.75, 0.5], [0.25, 0.5]])


def test_discriminability_by_hand():
    """Ranges 0.8 - 0.2 for both symbols."""
    assert phi.discriminability(Q) == pytest.approx(0.6)


@pytest.mark.parametrize(
    ('counts', 'expected'), [([0, 0], 0.0), ([0, 3], 0.0), ([2, 2], 1.0), ([1, 4], 0.25), ([3, 2, 6], 1 / 3)]
)
def test_class_uniformity_by_hand(counts, expected):
    assert phi.class_uniformity(counts) == pytest.approx(expected)


def test_instance_variation_by_hand():
    """Column mean 0.5, deviation sqrt(2 * 0.09 / 3) = sqrt(0.06); relative 0.4899; divided by sqrt(2)."""
    assert phi.instance_variation(Q) == pytest.approx(np.sqrt(0.06) / 0.5 / np.sqrt(2))


def test_instance_variation_is_one_when_one_object_has_all_the_probability():
    q = np.full((7, 2), 1e-12)
    q[3] = 0.9
    assert phi.instance_variation(q) == pytest.approx(1.0)


def test_prediction_margin_by_hand():
    """Margins 0.6, 0 and 0.6; the third symbol of the second case must not count."""
    assert phi.prediction_margin(Q) == pytest.approx(0.4)
    assert phi.prediction_margin(np.array([[0.5, 0.3, 0.2]])) == pytest.approx(0.2)


def test_entropy_by_hand():
    """At even odds log 2; else against scipy."""
    np.testing.assert_allclose(phi.prediction_entropy(Q)[1], np.log(2))
    np.testing.assert_allclose(phi.prediction_entropy(Q), [entropy(row) for row in Q])


def test_single_object():
    """Nothing can vary among one object; its margin still counts."""
    q = np.array([[0.9, 0.3]])
    assert phi.discriminability(q) == 0
    assert phi.instance_variation(q) == 0
    assert phi.prediction_margin(q) == pytest.approx(0.5)


def test_environment_features_by_hand():
    assert phi.budget_consumption(3, 12) == pytest.approx(0.25)
    assert phi.budget_consumption(0, 0) == 1, 'a budget of nothing is spent from the start'
    assert phi.remaining_time(30, 40) == pytest.approx(0.75)
    assert phi.non_query_time(3, 10) == pytest.approx(0.3)
    assert phi.non_query_time(25, 10) == 1


@given(q=beliefs, counts=st.lists(st.integers(0, 50), min_size=2, max_size=4))
def test_features_lie_in_the_unit_interval(q, counts):
    for value in (*(feature(q) for feature in OF_BELIEFS), phi.class_uniformity(counts)):
        assert -1e-12 <= value <= 1 + 1e-12


@given(q=beliefs, seed=st.integers(0, 1000))
def test_order_of_objects_and_symbols_does_not_matter(q, seed):
    rng = np.random.default_rng(seed)
    shuffled = q[rng.permutation(q.shape[0])][:, rng.permutation(q.shape[1])]
    for feature in OF_BELIEFS:
        assert feature(shuffled) == pytest.approx(feature(q), abs=1e-9)


def test_leading_axes_are_independent_states():
    """A whole look-ahead at once must equal one state at a time."""
    q = np.random.default_rng(0).uniform(0.01, 0.99, size=(3, 2, 5, 4))
    for feature in OF_BELIEFS:
        np.testing.assert_allclose(feature(q), [[feature(state) for state in row] for row in q], atol=1e-14)
    counts = np.array([[1, 2], [0, 0]])
    np.testing.assert_array_equal(phi.class_uniformity(counts), [0.5, 0.0])
