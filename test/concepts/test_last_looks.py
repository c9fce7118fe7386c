"""New looks at an object, and those that only stay."""

import numpy as np

from al_questioner.concepts.last_looks import LastLooks


def test_only_what_changed_is_new():
    """A thing that stays would count with every turn, and one that changes back would not count."""
    looks, first = LastLooks(), np.array([[1, 2], [3, 4]], dtype=np.float32)
    assert looks.take((7, 8), first) == [0, 1]
    assert looks.take((8, 7), first[::-1]) == [], 'the order of the objects is no change'
    assert looks.take((7, 8), first + np.float32([[0], [1]])) == [1]
    assert looks.take((7, 8), first) == [1]
    assert looks.take((9,), first[:1]) == [0], 'another object that looks alike'


def test_looks_are_the_same_to_the_last_bit_only():
    """Otherwise what is kept would hold fewer views than its learner has counted: 0 is not -0."""
    looks = LastLooks()
    looks.take((1,), np.array([[0.0]]))
    assert looks.take((1,), np.array([[1e-60]])) == [], 'a float32 does not tell these apart'
    assert looks.take((1,), np.array([[-0.0]])) == [0]


def test_nothing_in_view_is_nothing_new():
    """An empty table would end the learner."""
    assert LastLooks().take((), np.empty((0, 3))) == []
