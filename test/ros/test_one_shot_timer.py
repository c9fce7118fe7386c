"""A job at a later time is put off and called off, on a clock that only the test moves."""

from __future__ import annotations

import pytest

from al_questioner.ros.one_shot_timer import OneShotTimer
from shared.virtual_time import VirtualTime


@pytest.fixture
def time() -> VirtualTime:
    return VirtualTime()


@pytest.fixture
def rung() -> list[float]:
    return []


@pytest.fixture
def timer(time: VirtualTime, rung: list[float]) -> OneShotTimer:
    return OneShotTimer(time.after, lambda: rung.append(time.now))


@pytest.mark.parametrize(('first', 'second'), [(100.0, 1.0), (1.0, 5.0)])
def test_the_time_that_was_set_last_counts_and_it_goes_off_once(
    time: VirtualTime, rung: list[float], timer: OneShotTimer, first: float, second: float
) -> None:
    """Otherwise a turn would time out twice, or when the time of the question before was over."""
    timer.set(first)
    timer.set(second)
    time.pass_until(200.0)
    assert rung == [second]


def test_what_is_cleared_does_not_go_off(time: VirtualTime, rung: list[float], timer: OneShotTimer) -> None:
    """Otherwise a turn would be over although its answer has come."""
    timer.set(1.0)
    timer.clear()
    time.pass_until(2.0)
    assert rung == []
    timer.set(1.0)
    time.pass_until(4.0)
    assert rung == [3.0]
