"""A person as the questioner."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from al_questioner.domain import SettingsError
from al_questioner.questioning import Human, expected_features, make_strategy


def test_a_choice_is_a_demonstration_to_learn_from(toy: Any) -> None:
    """Recorded choices of a person would lack the features that imitation needs."""
    context = toy.context()
    choice = Human(lambda _: 4).choose(context, np.random.default_rng(0))
    assert choice.index == 4
    assert choice.utilities.tolist() == [float(i == 4) for i in range(len(context.candidates))]
    np.testing.assert_array_equal(choice.features, expected_features(context))


def test_without_a_person_it_is_refused() -> None:
    """A program without a terminal would wait for ever."""
    with pytest.raises(SettingsError, match='nobody is there to choose'):
        make_strategy('human', {})
