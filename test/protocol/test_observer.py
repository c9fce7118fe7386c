"""A machine that follows an episode from the outside."""

from __future__ import annotations

import pytest

from al_questioner.bags import deserialize
from al_questioner.domain import EpisodeError, QueryRecord
from al_questioner.messages import documents
from al_questioner.protocol.observer import ObserverMachine
from al_questioner.protocol.topics import Health, Status
from shared.bags import recorded
from shared.machine_driver import Driver

STATES = [deserialize(message).data for message in recorded('learner_state')]
EPISODE = documents.read('learner_state', STATES[-1])['episode_id']
PATIENCE = 30.0


class Watcher:
    """Somebody who counts the turns and the queries that they are told of, until they break."""

    def __init__(self, error: BaseException | None = None) -> None:
        self.told: list[tuple[int, int]] = []
        self._error = error

    def __call__(self, turn: int, queries: tuple[QueryRecord, ...]) -> None:
        self.told.append((turn, len(queries)))
        if self._error is not None:
            raise self._error


def observe(watcher: Watcher, episode_id: str = EPISODE) -> tuple[ObserverMachine, Driver]:
    machine = ObserverMachine(episode_id, watcher, PATIENCE, 'robot')
    driver = Driver(machine)
    driver.start()
    assert driver.status == 'watching the learner'
    return machine, driver


def test_every_state_is_handed_on_until_the_episode_is_over() -> None:
    """Otherwise a person would not see how the episode goes."""
    watcher = Watcher()
    machine, driver = observe(watcher)
    for state in STATES:
        assert not machine.done
        driver.hear('learner_state', state)
    assert machine.done
    last = documents.read('learner_state', STATES[-1])
    assert len(watcher.told) == len(STATES)
    assert watcher.told[-1] == (last['turn'], len(last['queries']))
    # A repetition is nothing new.
    driver.hear('learner_state', STATES[-1])
    assert len(watcher.told) == len(STATES)


def test_another_episode_is_not_followed() -> None:
    """Otherwise a learner in the same namespace would be shown in place of ours."""
    watcher = Watcher()
    machine, driver = observe(watcher, 'ours')
    driver.hear('learner_state', STATES[-1])
    assert watcher.told == []
    assert not machine.done


@pytest.mark.parametrize('error', [OSError('the output is closed'), SystemExit(1)])
def test_a_watcher_that_fails_ends_the_episode(error: BaseException) -> None:
    """Otherwise an episode would go on that nobody sees."""
    machine, driver = observe(Watcher(error))
    with pytest.raises(type(error)):
        driver.hear('learner_state', STATES[-1])
    assert machine.failure is error
    assert not machine.done


def test_an_error_of_a_node_of_ours_is_the_end() -> None:
    """Otherwise a person would wait for a learner that cannot go on."""
    machine, driver = observe(Watcher())
    fine = Status('robot/learner', Health.OK, 'turn 3')
    driver.hear('/diagnostics', (fine, Status('robot_2/learner', Health.ERROR, 'not ours')))
    assert machine.failure is None
    driver.hear('/diagnostics', (fine, Status('robot/teacher', Health.ERROR, 'no such symbol')))
    assert isinstance(machine.failure, EpisodeError)
    assert str(machine.failure) == 'robot/teacher: no such symbol'


def test_a_warning_is_the_end_only_when_nothing_has_happened_for_long() -> None:
    """Otherwise a refused message would end an episode; or one that stands still would never end."""
    machine, driver = observe(Watcher())
    warning = (Status('robot/learner', Health.WARNING, 'waiting for objects for too long'),)
    driver.pass_until(PATIENCE - 1)
    driver.hear('learner_state', STATES[0])
    driver.pass_until(2 * PATIENCE - 1)
    driver.hear('/diagnostics', warning)
    assert machine.failure is None
    driver.pass_until(2 * PATIENCE)
    driver.hear('/diagnostics', (Status('robot/learner', Health.STALE, ''),))
    assert machine.failure is None
    driver.hear('/diagnostics', warning)
    assert str(machine.failure) == 'robot/learner: waiting for objects for too long'
