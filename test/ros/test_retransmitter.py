"""Saying a thing until it is heard, on a clock that only the test moves."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import pytest

from al_questioner.ros.retransmitter import BackOff, Retransmitter


class Time:
    """A clock and its timers; also the node that waits for them."""

    def __init__(self) -> None:
        self.now = 0.0
        self.timers: list[tuple[float, Callable[[], None]]] = []

    def monotonic(self) -> float:
        return self.now

    def after(self, seconds: float, job: Callable[[], None]) -> None:
        self.timers.append((self.now + seconds, job))

    def pass_until(self, end: float) -> None:
        while due := [timer for timer in self.timers if timer[0] <= end]:
            timer = min(due, key=lambda timer: timer[0])
            self.timers.remove(timer)
            self.now = timer[0]
            timer[1]()
        self.now = end


@pytest.fixture
def time(monkeypatch: pytest.MonkeyPatch) -> Time:
    result = Time()
    monkeypatch.setattr('al_questioner.ros.one_shot_timer.time', SimpleNamespace(monotonic=result.monotonic))
    return result


@pytest.fixture
def said() -> list[tuple[float, str]]:
    return []


@pytest.fixture
def repeater(time: Time, said: list[tuple[float, str]]) -> Retransmitter[str]:
    return Retransmitter(time, lambda thing: said.append((time.now, thing)), BackOff(1.0, 4.0))


def test_it_is_said_ever_more_rarely_until_it_is_heard(time: Time, said: list, repeater: Retransmitter[str]) -> None:
    """A question would be asked once, or fill the topic, or be asked after it was answered."""
    repeater.say('why?')
    time.pass_until(12.0)
    assert said == [(at, 'why?') for at in (0.0, 1.0, 3.0, 7.0, 11.0)]
    repeater.stop()
    time.pass_until(100.0)
    assert len(said) == 5
    assert repeater.said is None


def test_the_next_thing_begins_anew(time: Time, said: list, repeater: Retransmitter[str]) -> None:
    """After one long wait every further question would be repeated rarely, or the old one go on."""
    repeater.say('why?')
    time.pass_until(8.0)
    repeater.say('how?')
    time.pass_until(11.5)
    assert said[4:] == [(8.0, 'how?'), (9.0, 'how?'), (11.0, 'how?')]
    time.pass_until(100.0)
    assert [at for at, _ in said[7:]] == [15.0 + 4 * i for i in range(22)]


def test_a_delay_is_kept(time: Time, said: list, repeater: Retransmitter[str]) -> None:
    """A teacher who takes time to think would answer at once."""
    repeater.say('because', delay=2.5)
    time.pass_until(4.0)
    assert said == [(2.5, 'because'), (3.5, 'because')]


def test_quick_talk_leaves_no_timers_behind(time: Time, said: list, repeater: Retransmitter[str]) -> None:
    """A thread waits for each timer: a fast episode would start thousands of them."""
    for turn in range(1000):
        repeater.say(str(turn))
        repeater.stop()
        time.now += 0.001
    assert len(time.timers) <= 1
