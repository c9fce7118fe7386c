"""The machine that shows recorded scenes to a live learner."""

from __future__ import annotations

from typing import Any

import pytest

from al_questioner.messages.stamps import stamp_members
from al_questioner.protocol.recorded_perception import PRESSED, RecordedPerceptionMachine
from al_questioner.protocol.topics import Replayed
from shared.machine_driver import Driver

WORLD = {'task': 'prepare_lunch', 'seed': 0, 'sample': 0, 'dataset': None}


@pytest.fixture
def others() -> list[str]:
    return []


@pytest.fixture
def driver(others: list[str]) -> Driver:
    driver = Driver(RecordedPerceptionMachine({1: b'one', 2: b'second'}, WORLD, len, lambda: others))
    driver.start()
    return driver


def begin(driver: Driver, turn: int, stamp: int = 5, world: Any = None, episode_id: str = 'e') -> None:
    """Begin a turn."""
    driver.hear_document('turn', episode_id, {'turn': turn, 'stamp': stamp_members(stamp), 'world': world})


def test_a_turn_gets_what_was_recorded_in_it_under_the_live_stamp(driver: Driver) -> None:
    """Otherwise the learner would take no scene, since each is older than its turn."""
    assert driver.status == 'waiting for a turn'
    begin(driver, 2, 77)
    shown: list[Replayed] = driver.published('objects')
    assert [(one.data, one.stamp) for one in shown] == [(b'second', 77)]
    assert driver.status == 'turn 2: 6 objects'
    assert driver.machine.turn == 2


def test_other_turns_than_the_recorded_ones_are_refused_with_their_number(driver: Driver) -> None:
    """Otherwise a learner with more turns than the bag would wait without a word."""
    begin(driver, 3)
    assert driver.refusals == [('turn', 'no scene of turn 3 was recorded, the last is that of 2')]
    assert not driver.machine.over


def test_two_perceptions_are_one_too_many(driver: Driver, others: list[str]) -> None:
    """Otherwise a learner would see the recorded scene in one turn and another one in the next."""
    begin(driver, 1)
    assert not driver.machine.over
    others.append('/perception')
    begin(driver, 2)
    assert driver.machine.over
    assert '/perception shows objects, too' in str(driver.machine.failure)
    assert len(driver.published('objects')) == 1


@pytest.mark.parametrize(('key', 'ends'), [('q', True), ('x', False)])
def test_a_person_can_quit(driver: Driver, key: str, ends: bool) -> None:
    """Otherwise only a signal would end it, or any key that is touched."""
    driver.enter(PRESSED, key)
    begin(driver, 1)
    assert driver.machine.over == ends
    assert driver.machine.failure is None
    assert bool(driver.published('objects')) != ends


def test_a_learner_of_another_world_is_warned_of_once_and_shown_the_scenes(driver: Driver) -> None:
    """Otherwise the scripted teacher would answer about things that are not there, and nobody would know why."""
    begin(driver, 1, world=WORLD)
    assert driver.lines == []
    for turn, episode_id, lines in ((1, 'e', 1), (2, 'e', 1), (1, 'another', 2)):
        begin(driver, turn, world={**WORLD, 'seed': 9}, episode_id=episode_id)
        assert len(driver.lines) == lines
    assert all('seed 9, recorded 0' in line for line in driver.lines)
    assert len(driver.published('objects')) == 4
