"""Scenes: what is asked of them by object, and the groups of their features."""

import numpy as np
import pytest

from al_questioner.domain import InputError, groups_of
from shared.scenes import make_scene


def test_features_are_those_of_the_object():
    """A teacher's name would be learnt for the object that stands beside the one that was named."""
    scene = make_scene([[1.0], [2.0]], (7, 3), ('size_height',))
    np.testing.assert_array_equal(scene.features_of(3), [2.0])
    with pytest.raises(InputError, match='object 4 is not in the scene'):
        scene.features_of(4)


def test_groups_are_in_the_order_in_which_they_occur():
    """Otherwise questions would name the groups in another order than the features come in."""
    assert groups_of(('size_height', 'colour_red', 'size_width', 'weight')) == ('size', 'colour', 'weight')
    assert groups_of(()) == ()
