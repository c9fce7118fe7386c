"""Turns and scenes on a clock that jumps."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.messages.stamps import SECOND, stamp_members
from al_questioner.protocol.turn_stamps import LATEST, TurnStamps

TIMES = st.integers(0, 2**63 - 1)


@given(TIMES.filter(lambda time: time <= LATEST), st.lists(TIMES, min_size=1))
def test_stamps_grow_and_fit_into_a_message_whatever_the_clock_shows(last: int, times: list[int]) -> None:
    """A scene of an earlier turn is not taken for one of this turn, and the next turn has a stamp."""
    stamps = TurnStamps([last])
    given = [stamps.begin(now) for now in times]
    assert sorted({last, *given}) == [last, *given]
    assert stamp_members(given[-1])['sec'] < 2**31


@given(st.lists(st.tuples(TIMES, st.booleans())))
def test_copies_of_a_stamp_are_of_its_turn_alone(times: list[tuple[int, bool]]) -> None:
    """A late message of simulated perception from an earlier turn is not learnt from."""
    stamps, earlier = TurnStamps(), []
    for now, begins in times:
        if begins:
            earlier.append(stamps.last)
            stamps.begin(now)
        assert stamps.is_of_turn(stamps.last, now)
        assert not any(stamps.is_of_turn(stamp, now) for stamp in earlier)


@given(st.lists(TIMES.filter(lambda time: time <= LATEST), min_size=1, unique=True).map(sorted), TIMES)
def test_stamps_of_before_are_known_after_a_new_start(earlier: list[int], now: int) -> None:
    """Otherwise a learner that goes on after the clock went back would learn from an old scene that is latched."""
    stamps = TurnStamps(earlier)
    stamps.begin(now)
    assert not any(stamps.is_of_turn(stamp, now) for stamp in earlier)


def test_on_a_clock_that_goes_forward_scenes_are_not_older_than_the_turn() -> None:
    """Otherwise a picture from before the person moved the things would be learnt from."""
    stamps = TurnStamps()
    stamps.begin(100)
    assert [stamps.is_of_turn(stamp, 110) for stamp in (0, 99, 100, 105, 10**12)] == [False, False, True, True, True]


@pytest.mark.parametrize('between_turns', [True, False])
def test_after_the_clock_went_back_a_camera_is_seen_again(between_turns: bool) -> None:
    """Otherwise one wrong time would blind the robot until the clock shows it again, perhaps for ever."""
    stamps = TurnStamps()
    stamps.begin(1000 * SECOND)
    if between_turns:
        assert stamps.begin(10 * SECOND) == 1000 * SECOND + 1
    assert stamps.last > 10 * SECOND
    # From before it went back; from before the turn, or before it was known that it went back.
    assert not stamps.is_of_turn(999 * SECOND, 10 * SECOND)
    assert not stamps.is_of_turn(9 * SECOND, 11 * SECOND)
    assert stamps.is_of_turn(11 * SECOND, 11 * SECOND)
    assert not stamps.is_of_turn(12 * SECOND, 11 * SECOND)
