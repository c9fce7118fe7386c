"""A machine that has everything recorded, and notices holes and the end of an episode."""

from __future__ import annotations

import errno
from collections.abc import Callable
from pathlib import Path

import pytest

from al_questioner.bags import BagError, deserialize
from al_questioner.domain import EpisodeError, InputError
from al_questioner.messages import documents
from al_questioner.protocol.effects import CloseBag, Effect, Level, Record, Report, Say, SyncBag
from al_questioner.protocol.recorder import DRAIN, SYNC_PERIOD, RecorderMachine
from al_questioner.protocol.topics import Recorded
from shared.bags import recorded
from shared.machine_driver import Driver

NAMES = {name: f'/lab/{name}' for name in ('turn', 'objects', 'answer', 'learner_state')}
STATES = [deserialize(message).data for message in recorded('learner_state')]
EPISODE = documents.read('learner_state', STATES[-1])['episode_id']


class Disk:
    """A disk that may be full, on which a bag may be left that can be repaired."""

    def __init__(self) -> None:
        self.is_full = self.is_repairable = False

    def do(self, effect: Effect) -> None:
        """Write, as long as it can."""
        if self.is_full and isinstance(effect, (Record, SyncBag, CloseBag)):
            raise OSError(errno.ENOSPC, 'No space left on device')

    def failure_of(self, error: OSError) -> EpisodeError | BagError:
        """The failure of an error."""
        return (EpisodeError if self.is_repairable else BagError)(f'the bag: {error.strerror}')


def record(until_done: bool = False, disk: Disk | None = None) -> tuple[RecorderMachine, Driver]:
    disk = disk or Disk()
    machine = RecorderMachine(Path('bag'), NAMES, until_done, disk.failure_of)
    driver = Driver(machine, disk.do)
    driver.start()
    return machine, driver


def message(text: str, stamp: int = 7) -> Recorded:
    return Recorded(text.encode(), stamp, lambda: text)


def turn(number: int, episode_id: str = EPISODE) -> Recorded:
    members = {'turn': number, 'stamp': {'sec': 1, 'nanosec': 0}, 'world': None}
    return message(documents.write('turn', episode_id, members))


def test_every_message_is_recorded_as_it_came() -> None:
    """Otherwise the recording would not be what the robot sent."""
    machine, driver = record()
    assert driver.effects(Say) == [Say('recording to bag')]
    assert driver.effects(Report) == [Report('recording to bag')]
    driver.hear('answer', message('snack', 5))
    driver.hear('answer', message('fruit', 6))
    driver.hear('objects', message('no text is looked for here', 9))
    assert driver.effects(Record) == [
        Record('answer', b'snack', 5),
        Record('answer', b'fruit', 6),
        Record('objects', b'no text is looked for here', 9),
    ]
    assert machine.written == 3
    assert list(machine.counts().items()) == [
        *(('written of /lab/turn', 0), ('written of /lab/objects', 1), ('written of /lab/answer', 2)),
        *(('written of /lab/learner_state', 0), ('turns missed', 0)),
    ]


def test_all_is_brought_to_the_disk_twice_a_second() -> None:
    """Otherwise a crash would cost more than the last second."""
    _, driver = record()
    driver.pass_until(2.0)
    assert [at for at, effect in driver.done if isinstance(effect, SyncBag)] == [
        SYNC_PERIOD * number for number in (1, 2, 3, 4)
    ]


def test_what_was_missed_is_said() -> None:
    """Otherwise a user would find out after the person has gone that the recording cannot be learnt from."""
    machine, driver = record()
    driver.hear('turn', turn(4, 'e1'))
    driver.hear('turn', turn(4, 'e1'))
    driver.hear('turn', turn(5, 'e1'))
    driver.hear('turn', turn(1, 'e2'))
    missed = 'of episode e1 were missed: the recording cannot be used as a demonstration'
    assert driver.effects(Say)[1:] == [
        Say('recording episode e1 from turn 4 on'),
        Say(f'turns 1 to 3 {missed}', Level.WARNING),
        Say('recording episode e2 from turn 1 on'),
    ]
    driver.hear('turn', turn(8, 'e1'))
    assert driver.effects(Say)[-1] == Say(f'turns 6 to 7 {missed}', Level.WARNING)
    assert machine.counts()['turns missed'] == 5


def undecodable() -> str:
    raise InputError('it holds no text')


@pytest.mark.parametrize(('read', 'said'), [(lambda: 'no document', 'turn: not valid JSON'), (undecodable, 'no text')])
def test_what_is_no_document_is_recorded_and_refused(read: Callable[[], str], said: str) -> None:
    """The recording holds what a robot really sent, also when it went wrong."""
    machine, driver = record()
    driver.hear('turn', Recorded(b'?', 1, read))
    assert machine.written == 1
    ((topic, reason),) = driver.refusals
    assert topic == 'turn'
    assert said in reason


def test_the_end_of_an_episode_ends_the_recording_a_little_later() -> None:
    """Otherwise the last messages of other topics, which are under way, would be missing."""
    machine, driver = record(until_done=True)
    driver.hear('turn', turn(1))
    driver.hear('learner_state', message(STATES[-1]))
    driver.pass_until(0.9 * DRAIN)
    # A repeated state does not put the end off.
    driver.hear('learner_state', message(STATES[-1]))
    assert not machine.done
    driver.pass_until(DRAIN)
    assert machine.done
    assert isinstance(driver.done[-1][1], SyncBag)


def test_a_recording_that_is_to_go_on_does() -> None:
    """Otherwise a second episode would not be recorded."""
    machine, driver = record()
    driver.hear('turn', turn(1))
    driver.hear('learner_state', message(STATES[-1]))
    driver.pass_until(10.0)
    assert not machine.done


def test_an_episode_that_was_over_before_is_no_end() -> None:
    """Otherwise a recorder that is started before the next learner would end at once."""
    machine, driver = record(until_done=True)
    driver.hear('learner_state', message(STATES[-1]))
    driver.pass_until(10.0)
    assert not machine.done
    # One that is seen alive is, even if it was joined late.
    driver.hear('learner_state', message(STATES[-2]))
    driver.hear('learner_state', message(STATES[-1]))
    driver.pass_until(20.0)
    assert machine.done


@pytest.mark.parametrize('happens', ['a message', 'a sync', 'the end'])
def test_a_full_disk_ends_the_recording(happens: str) -> None:
    """Otherwise a robot would go on for hours without being recorded."""
    disk = Disk()
    machine, driver = record(disk=disk)
    driver.hear('answer', message('snack'))
    disk.is_full = disk.is_repairable = True
    happen: dict[str, Callable[[], None]] = {
        'a message': lambda: driver.hear('answer', message('fruit')),
        'a sync': lambda: driver.pass_until(SYNC_PERIOD),
        'the end': lambda: driver.perform(machine.finish()),
    }
    with pytest.raises(EpisodeError, match='the bag: No space left on device'):
        happen[happens]()
    assert isinstance(machine.failure, EpisodeError)
    assert machine.written == 1
    tried = len(driver.effects(Record)), len(driver.effects(SyncBag))
    driver.hear('answer', message('fruit'))
    driver.pass_until(10.0)
    assert (len(driver.effects(Record)), len(driver.effects(SyncBag))) == tried


def test_a_bag_of_which_nothing_is_left_is_a_fault_of_what_was_asked_for() -> None:
    """Otherwise the user would be told to repair what is not there."""
    disk = Disk()
    disk.is_full = True
    machine, driver = record(disk=disk)
    driver.hear('answer', message('snack'))
    assert isinstance(machine.failure, BagError)
    assert driver.refusals == []
    assert machine.written == 0


def test_the_bag_is_finished_once_no_more_comes() -> None:
    """Otherwise a recording would have to be repaired after each use."""
    machine, driver = record()
    driver.perform(machine.finish())
    assert driver.effects(CloseBag) == [CloseBag()]
    assert machine.failure is None
