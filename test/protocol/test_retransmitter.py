"""Saying a thing until it is heard, on a clock that only the test moves."""

from __future__ import annotations

import pytest
from al_questioner.ros.retransmitter import BackOff, Retransmitter

from shared.virtual_time import VirtualTime


@pytest.fixture
def time() -> VirtualTime:
    return VirtualTime()


@pytest.fixture
def said() -> list[tuple[float, str]]:
    return []


@pytest.fixture
def retransmitter(time: VirtualTime, said: list[tuple[float, str]]) -> Retransmitter[str]:
    return Retransmitter(time.after, lambda thing: said.append((time.now, thing)), BackOff(1.0, 4.0))


def test_it_is_said_ever_more_rarely_until_it_is_heard(
    time: VirtualTime, said: list, retransmitter: Retransmitter[str]
) -> None:
    """Otherwise a question would be asked once, or fill the topic, or be asked after it was answered."""
    retransmitter.send('why?')
    time.pass_until(12.0)
    assert said == [(at, 'why?') for at in (0.0, 1.0, 3.0, 7.0, 11.0)]
    retransmitter.stop()
    time.pass_until(100.0)
    assert len(said) == 5
    assert retransmitter.message is None


def test_the_next_thing_begins_anew(time: VirtualTime, said: list, retransmitter: Retransmitter[str]) -> None:
    """Otherwise after one long wait every further question would be repeated rarely, or the old one go on."""
    retransmitter.send('why?')
    time.pass_until(8.0)
    retransmitter.send('how?')
    time.pass_until(11.5)
    assert said[4:] == [(8.0, 'how?'), (9.0, 'how?'), (11.0, 'how?')]
    time.pass_until(100.0)
    assert [at for at, _ in said[7:]] == [15.0 + 4 * i for i in range(22)]


def test_a_delay_is_kept(time: VirtualTime, said: list, retransmitter: Retransmitter[str]) -> None:
    """Otherwise a teacher who takes time to think would answer at once."""
    retransmitter.send('because', delay=2.5)
    time.pass_until(4.0)
    assert said == [(2.5, 'because'), (3.5, 'because')]


def test_quick_talk_leaves_no_timers_behind(time: VirtualTime, said: list, retransmitter: Retransmitter[str]) -> None:
    """Otherwise a long episode would fill the memory with times at which nothing is to be done."""
    for turn in range(1000):
        retransmitter.send(str(turn))
        retransmitter.stop()
        time.now += 0.001
    assert time.waiting == 0
