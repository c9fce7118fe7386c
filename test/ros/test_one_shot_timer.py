"""One job at a later time, on a clock that only the test moves."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from al_questioner.ros.one_shot_timer import OneShotTimer


class Time:
    """A clock and its timers, which may go off too early; also the node that waits for them."""

    def __init__(self) -> None:
        self.now = 0.0
        self.timers: list[Callable[[], None]] = []

    def after(self, seconds: float, job: Callable[[], None]) -> None:
        self.timers.append(job)


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Time:
    result = Time()
    monkeypatch.setattr('al_questioner.ros.one_shot_timer.time', SimpleNamespace(monotonic=lambda: result.now))
    return result


@pytest.fixture
def rung() -> list[float]:
    return []


@pytest.fixture
def alarm(time: Time, rung: list[float]) -> OneShotTimer:
    return OneShotTimer(time, lambda: rung.append(time.now))


def test_an_earlier_time_overtakes_a_later_one_and_it_goes_off_once(
    time: Time, rung: list, alarm: OneShotTimer
) -> None:
    """A turn would be let pass twice, or as late as the first timer was set."""
    alarm.set(100.0)
    alarm.set(1.0)
    assert len(time.timers) == 2
    time.now = 1.0
    time.timers[1]()
    assert rung == [1.0]
    time.now = 100.0
    time.timers[0]()
    assert rung == [1.0]


def test_a_later_time_is_waited_for(time: Time, rung: list, alarm: OneShotTimer) -> None:
    """An answer's time would be over when that of the last question was."""
    alarm.set(1.0)
    alarm.set(5.0)
    assert len(time.timers) == 1
    time.now = 1.0
    time.timers[0]()
    assert rung == []
    time.now = 5.0
    time.timers[1]()
    assert rung == [5.0]


def test_what_is_cleared_does_not_go_off(time: Time, rung: list, alarm: OneShotTimer) -> None:
    """A turn would be over although its answer has come."""
    alarm.set(1.0)
    alarm.clear()
    time.now = 2.0
    time.timers[0]()
    assert rung == []
    assert len(time.timers) == 1
