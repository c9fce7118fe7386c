"""Description of a declared setting, and the numbers that it takes."""

from __future__ import annotations

import math

import pytest

from al_questioner.domain import Setting, SettingsError

BUDGET = Setting('budget', 25.0, 'query budget', 'cost', 0)
DELAY = Setting('delay', 0.0, 'time to answer', 's', 0, 3600)


@pytest.mark.parametrize(
    ('setting', 'explained'),
    [
        (DELAY, 'time to answer [s, 0 to 3600]'),
        (Setting('seed', 0, 'of what is drawn', lower=0), 'of what is drawn [0 or more]'),
        (Setting('frame_id', 'table', 'frame of the objects'), 'frame of the objects'),
    ],
)
def test_unit_and_range_are_told(setting: Setting[object], explained: str) -> None:
    """Otherwise a parameter file would not say in what its numbers are, or how large they may be."""
    assert setting.explained == explained


@pytest.mark.parametrize(
    ('setting', 'value', 'reason'),
    [
        (DELAY, 3600.5, 'delay must lie in [0, 3600] s, not 3600.5'),
        (DELAY, -1, 'delay must lie in [0, 3600] s, not -1'),
        (DELAY, math.nan, 'delay must be a finite number, not nan'),
        (BUDGET, -1.0, 'budget must be 0 or more, not -1.0'),
        (BUDGET, 1e13, 'budget must lie in [0, 1e+12], not 10000000000000.0'),
        (Setting('seed', 0, 'of all', lower=0), 2**63, f'seed must lie in [0, 9.22337e+18], not {2**63}'),
    ],
)
def test_numbers_outside_the_range_are_refused(setting: Setting[float], value: float, reason: str) -> None:
    """Otherwise sums would overflow, or ROS not be able to hold them."""
    with pytest.raises(SettingsError) as error:
        setting.check(value)
    assert str(error.value) == reason


def test_the_ends_of_the_range_are_taken() -> None:
    for value in (0, 3600.0):
        DELAY.check(value)
    Setting('seed', 0, 'of all', lower=0).check(2**63 - 1)
