"""A learner with a session log: a new one goes on where the last one ended."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from al_questioner.domain import EpisodeError
from al_questioner.event_log.events import AnswerAccepted
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.effects import Level, Say
from al_questioner.simulation import episode_settings
from shared.durable_sessions import events
from shared.learner_robot import Robot
from shared.lunches import TASK
from shared.offline import offline_queries

LABELS = episode_settings(TASK, 'u_sampling', 6.0, 5)


def test_a_log_changes_nothing_that_is_asked(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise an episode could not be compared with one that is not written down."""
    robot = make(tmp_path, settings=episode_settings(TASK, 'random_fsq', 6.0, 8))
    assert robot.plays() == offline_queries('random_fsq', 6.0, 8)


def test_what_was_answered_before_a_crash_is_known_after_it(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a teacher whose acknowledgement was lost would teach the same twice, or a thing be asked twice."""
    robot = make(tmp_path, settings=LABELS)
    robot.sees()
    answered = robot.said('query')[-1]
    assert robot.answers(answered, 'snack')['accepted']
    robot.sees()
    robot.machine.close()
    again = make(tmp_path, settings=LABELS)
    (pending,) = again.said('query')
    assert again.answers(answered, 'snack')['reason'] == 'already taken'
    assert again.answers(pending, 'fruit')['accepted']
    assert len(again.said('learner_state')[-1]['queries']) == 2
    stamps = [stamp_of(turn['stamp']) for turn in (*robot.said('turn'), *again.said('turn'))]
    assert stamps == sorted(stamps)


def test_a_learner_that_ended_between_turns_goes_on(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a learner that is stopped between two turns would wait for ever."""
    settings = episode_settings(TASK, 'u_sampling', 6.0, 2)
    robot = make(tmp_path, settings=settings, turn_period=3000.0)
    robot.sees()
    robot.is_taught()
    robot.machine.close()
    again = make(tmp_path, settings=settings)
    assert [turn['turn'] for turn in again.said('turn')] == [2]
    again.sees()
    again.is_taught()
    assert again.said('learner_state')[-1]['done']
    again.machine.close()
    over = make(tmp_path, settings=settings)
    assert over.said('turn') == over.said('query') == []
    assert over.said('learner_state') == again.said('learner_state')[-1:]


def test_a_learner_tells_that_another_version_began_its_session(
    make: Callable[..., Robot], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise nobody would know why from some turn on it asks in another way."""
    robot = make(tmp_path, settings=LABELS)
    robot.sees()
    robot.is_taught()
    robot.machine.close()
    monkeypatch.setattr('al_questioner.protocol.learner.SEMANTICS', 99)
    again = make(tmp_path, settings=LABELS)
    said = 'another version of the method began this session: its questions so far are taken as they were asked'
    assert Say(said, Level.WARNING) in again.driver.effects(Say)


def fill_disk(robot: Robot) -> None:
    """Let nothing more be written to the log of a learner."""
    robot.durable._log._storage._database.execute('PRAGMA query_only=1')


def test_a_learner_that_failed_between_two_turns_begins_none(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise it would look at a scene and ask a question that the learner after it does not know of."""
    robot = make(tmp_path, settings=LABELS, turn_period=3000.0)
    robot.sees()
    (query,) = robot.said('query')
    robot.answers(query, 'snack')
    (state,) = robot.said('learner_state')
    fill_disk(robot)
    with pytest.raises(EpisodeError, match='cannot be written'):
        robot.answers(query, 'fruit', answer_id='a2', replaces='a1')
    before = list(robot.order)
    robot.driver.pass_until(7000.0)
    # The last state is still true, and is said again for those who have missed it.
    assert set(robot.order[len(before) :]) <= {'learner_state'}
    assert all(said == state for said in robot.said('learner_state'))
    assert [turn['turn'] for turn in robot.said('turn')] == [1]


def test_a_learner_that_failed_tells_of_no_state(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise it would tell of a scene that is not in its log, which the learner after it has never seen."""
    robot = make(tmp_path, settings=LABELS)
    robot.sees()
    (query,) = robot.said('query')
    robot.answers(query, 'snack')
    robot.sees()
    for _ in range(2):
        robot.answers(query, 'fruit', answer_id='b1', teacher_id='bert')
    robot.is_taught()
    fill_disk(robot)
    with pytest.raises(EpisodeError, match='cannot be written'):
        robot.sees()
    before = list(robot.order)
    # It is in the log already, so that nothing has to be written for it.
    assert not robot.answers(query, 'fruit', answer_id='b1', teacher_id='bert')['accepted']
    robot.driver.pass_until(1000.0)
    assert robot.order[len(before) :] == ['answer_ack']


def test_after_a_full_disk_a_new_learner_asks_the_same(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise an answer that was not acknowledged would be lost, or count twice once it is said again."""
    robot = make(tmp_path, settings=LABELS)
    robot.sees()
    robot.is_taught()
    robot.sees()
    robot.durable._log._storage._database.execute('PRAGMA query_only=1')
    with pytest.raises(EpisodeError, match='cannot be written'):
        robot.driver.hear('answer', 'snack')
    robot.machine.close()
    again = make(tmp_path, settings=LABELS)
    assert again.said('query') == robot.said('query')[-1:]
    assert again.answers(again.said('query')[0], 'snack')['accepted']
    assert sum(isinstance(event, AnswerAccepted) for event in events(tmp_path)) == 2
