"""Saying a thing until it is heard, on a clock that only the test moves."""

from __future__ import annotations

import pytest

from al_questioner.protocol.effects import Publish
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.retransmitter import BackOff, Retransmitter
from shared.machine_driver import Driver

WHY, HOW = Publish('query', 'why?'), Publish('query', 'how?')


@pytest.fixture
def driver() -> Driver:
    return Driver(Machine())


@pytest.fixture
def retransmitter(driver: Driver) -> Retransmitter:
    return Retransmitter(driver.machine, 'query', BackOff(1.0, 4.0))


def said(driver: Driver) -> list[tuple[float, str]]:
    """Return what was said, and when."""
    return [(at, effect.content) for at, effect in driver.done if isinstance(effect, Publish)]


def test_it_is_said_ever_more_rarely_until_it_is_heard(driver: Driver, retransmitter: Retransmitter) -> None:
    """Otherwise a question would be asked once, or fill the topic, or be asked after it was answered."""
    driver.perform(retransmitter.send(WHY))
    driver.pass_until(12.0)
    assert said(driver) == [(at, 'why?') for at in (0.0, 1.0, 3.0, 7.0, 11.0)]
    driver.perform(retransmitter.stop())
    driver.pass_until(100.0)
    assert len(said(driver)) == 5
    assert retransmitter.message is None


def test_the_next_thing_begins_with_the_shortest_pause(driver: Driver, retransmitter: Retransmitter) -> None:
    """Otherwise after one long wait every further question would be repeated rarely, or the old one go on."""
    driver.perform(retransmitter.send(WHY))
    driver.pass_until(8.0)
    driver.perform(retransmitter.send(HOW))
    driver.pass_until(11.5)
    assert said(driver)[4:] == [(8.0, 'how?'), (9.0, 'how?'), (11.0, 'how?')]
    driver.pass_until(100.0)
    assert [at for at, _ in said(driver)[7:]] == [15.0 + 4 * i for i in range(22)]


def test_a_delay_is_kept(driver: Driver, retransmitter: Retransmitter) -> None:
    """Otherwise a teacher who takes time to think would answer at once."""
    driver.perform(retransmitter.send(WHY, delay=2.5))
    driver.pass_until(4.0)
    assert said(driver) == [(2.5, 'why?'), (3.5, 'why?')]


def test_quick_talk_leaves_no_timers_behind(driver: Driver, retransmitter: Retransmitter) -> None:
    """Otherwise a long episode would fill the memory with times at which nothing is to be done."""
    for _ in range(1000):
        driver.perform(retransmitter.send(WHY))
        driver.perform(retransmitter.stop())
        driver.seconds += 0.001
    assert driver.timers == {}
