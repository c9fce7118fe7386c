"""A teacher who is away: the learner goes on without, and takes the answer whenever it comes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from al_questioner.protocol.learner import ANSWER_TIMEOUT
from al_questioner.simulation import episode_settings
from shared.learner_robot import Robot
from shared.lunches import TASK

TIMEOUT = 3.0
AWAY = episode_settings(TASK, 'u_sampling', 4.0, 1000, change_interval=1000)
"""Settings of an episode whose things stay where they are."""


def passes(robot: Robot) -> None:
    """Let a turn pass in which nobody answers."""
    robot.sees()
    robot.driver.pass_until(robot.driver.timers[ANSWER_TIMEOUT])


def test_an_episode_without_a_teacher_comes_to_its_end(make: Callable[..., Robot]) -> None:
    """A teacher who never comes does not stall the episode; no label is guessed, no budget taken for nothing."""
    robot = make(settings=episode_settings(TASK, 'u_sampling', 4.0, 5, change_interval=10), answer_timeout=TIMEOUT)
    for _ in range(5):
        passes(robot)
    state = robot.said('learner_state')[-1]
    assert state['done']
    assert (state['turn'], state['spent'], sum(state['labels'].values())) == (5, 0.0, 0)
    assert [query['outcome'] for query in state['queries']] == ['unanswered']
    assert {query['query_id'] for query in robot.said('query')} == {'q1'}


def test_the_question_is_asked_again_word_for_word_and_answered_late(make: Callable[..., Robot]) -> None:
    """Otherwise somebody who comes back would find no question, or another one; what they say would be refused."""
    robot = make(settings=AWAY, answer_timeout=TIMEOUT)
    for _ in range(3):
        passes(robot)
    robot.sees()
    first, *others = robot.said('query')
    assert others
    assert all(query == first for query in others)
    robot.is_taught()
    assert robot.said('answer_ack')[-1]['accepted']
    (answered,) = robot.said('learner_state')[-1]['queries']
    assert (answered['turn'], answered['object_id'], answered['outcome']) == (1, first['object_id'], 'answered')
    assert answered['answered_in'] == 4
    robot.sees()
    assert robot.said('query')[-1]['query_id'] == 'q2'


def test_a_session_remembers_that_nobody_answered(make: Callable[..., Robot], tmp_path: Path) -> None:
    """A learner that is started again does not repeat the turns that had passed."""
    robot = make(tmp_path, settings=AWAY, answer_timeout=TIMEOUT)
    for _ in range(2):
        passes(robot)
    robot.sees()
    robot.machine.close()
    again = make(tmp_path, settings=AWAY)
    assert again.said('query') == robot.said('query')[-1:]
    assert again.said('turn')[-1]['turn'] == 3
    assert again.machine.warning(again.driver.now) == 'nobody has answered for 2 turns'
    again.is_taught()
    (answered,) = again.said('learner_state')[-1]['queries']
    assert (answered['turn'], answered['answered_in']) == (1, 3)


def test_an_answer_between_the_turns_begins_no_turn_of_its_own(make: Callable[..., Robot]) -> None:
    """Otherwise two turns would begin at once, and the robot look at one scene for two."""
    robot = make(settings=AWAY, answer_timeout=TIMEOUT, turn_period=3000.0)
    passes(robot)
    robot.is_taught()
    assert robot.said('answer_ack')[-1]['accepted']
    state = robot.said('learner_state')[-1]
    assert (state['turn'], len(state['queries'])) == (1, 1)
    robot.driver.pass_until(2999.0)
    assert {turn['turn'] for turn in robot.said('turn')} == {1}
    robot.driver.pass_until(3000.0)
    assert robot.said('turn')[-1]['turn'] == 2
