"""Warnings about scenes from before the turn, at times that only the test sets."""

from __future__ import annotations

import pytest

from al_questioner.domain import SceneError
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.events import Moment
from al_questioner.protocol.stale_scenes import FEWEST, PATIENCE, StaleScenes

TURN = 100 * SECOND


@pytest.fixture
def stale() -> StaleScenes:
    return StaleScenes()


def test_what_was_under_way_as_the_turn_began_is_no_concern(stale: StaleScenes) -> None:
    """Otherwise at nearly every start beside a camera that takes a while, a right clock would be called wrong."""
    seconds = 0.0
    for turn in range(3):
        stale.begin_turn(seconds)
        for _ in range(50):
            stale.pass_over(TURN - 1, TURN, Moment(seconds, TURN))
            seconds += PATIENCE / 51
        assert seconds == pytest.approx((turn + 1) * PATIENCE * 50 / 51)


def test_nothing_but_old_scenes_is_a_concern_after_a_while(stale: StaleScenes) -> None:
    """Otherwise a camera whose clock is behind would be passed over in silence for ever."""
    old, late = TURN - 5 * SECOND, PATIENCE * (FEWEST - 1)
    for number in range(1, FEWEST):
        stale.pass_over(old, TURN, Moment(PATIENCE * number, TURN))
    with pytest.raises(SceneError, match=r'older than the turn, the last one by 5\.0 s: our clock has gone back'):
        stale.pass_over(old, TURN, Moment(late, TURN - 1))
    stale.begin_turn(late)
    for _ in range(FEWEST):
        stale.pass_over(old, TURN, Moment(late, TURN))


def test_a_scene_without_a_stamp_is_named_as_such_at_once(stale: StaleScenes) -> None:
    """Otherwise a user who forgot the stamp would look for what is wrong with the clocks."""
    with pytest.raises(SceneError, match='the stamp of the cloud is 0'):
        stale.pass_over(0, TURN, Moment(0.0, TURN))


def test_how_far_a_clock_is_behind_stays_the_same_as_the_turn_goes_on(stale: StaleScenes) -> None:
    """The warning about a clock that is a minute behind always says a minute."""
    for _ in range(FEWEST):
        stale.pass_over(TURN - 60 * SECOND, TURN, Moment(0.0, TURN))
    for later in (3, 5, 9):
        with pytest.raises(SceneError, match=r'is 60\.0 s ago: is the clock of their sender behind\?'):
            stale.pass_over(TURN + (later - 60) * SECOND, TURN, Moment(later, TURN + later * SECOND))


def test_each_turn_counts_its_own_old_scenes(stale: StaleScenes) -> None:
    """Otherwise the few old scenes of each turn would add up, and a right clock be called wrong."""
    for _ in range(FEWEST - 1):
        stale.pass_over(TURN - 1, TURN, Moment(0.0, TURN))
    stale.begin_turn(1.0)
    late = Moment(1.0 + PATIENCE, TURN)
    for _ in range(FEWEST - 1):
        stale.pass_over(TURN - 1, TURN, late)
    with pytest.raises(SceneError, match='all clouds are older than the turn'):
        stale.pass_over(TURN - 1, TURN, late)
