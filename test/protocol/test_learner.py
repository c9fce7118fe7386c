"""The machine of a learner: its turns, its answers, what it says again, and what it warns of."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from al_questioner.domain import EpisodeError
from al_questioner.event_log.events import InputRejected
from al_questioner.messages import documents
from al_questioner.messages.stamps import SECOND, stamp_of
from al_questioner.protocol.effects import Effect, End, Level, Report, Say, WriteFile
from al_questioner.protocol.events import Moment
from al_questioner.protocol.learner import ANSWER_TIMEOUT, LONGEST_BACK_OFF, LearnerOptions
from al_questioner.protocol.topics import BeliefsShown, DecisionMade
from al_questioner.questioning import STRATEGIES
from al_questioner.simulation import PerceivedWorld, episode_settings
from al_questioner.support.files import write_text
from shared.durable_sessions import WORLD, events
from shared.learner_robot import Robot
from shared.lunches import TASK
from shared.offline import offline_queries

SETTINGS = episode_settings(TASK, 'farthest_fsq', 6.0, 8)


@pytest.mark.parametrize('strategy', [name for name in STRATEGIES if name != 'human'])
def test_an_episode_asks_what_an_offline_run_asks(make: Callable[..., Robot], strategy: str) -> None:
    """A result that is found offline holds for the robot."""
    robot = make(settings=episode_settings(TASK, strategy, 8.0, 14))
    assert robot.plays() == offline_queries(strategy, 8.0, 14)
    state = robot.said('learner_state')[-1]
    assert state['done']
    assert state['spent'] <= 8.0
    assert all(ack['accepted'] for ack in robot.said('answer_ack'))
    assert [turn['turn'] for turn in robot.said('turn')] == list(range(1, 15))
    assert robot.driver.status == 'the episode is over'
    assert set(robot.driver.timers) == {'repeat learner_state'}


@pytest.mark.parametrize(
    ('strategy', 'budget', 'changes'),
    [('farthest_fsq', 30.0, {'carry_labels': True}), ('u_sampling', 8.0, {'amplitude': 4.0, 'kernel_shape': 'rbf'})],
)
def test_other_settings_decide_and_are_told(
    make: Callable[..., Robot], strategy: str, budget: float, changes: dict[str, Any]
) -> None:
    """Otherwise a setting would not reach the models, or a bag would not tell of it."""
    robot = make(settings=episode_settings(TASK, strategy, budget, 14, **changes))
    asked = robot.plays()
    assert asked == offline_queries(strategy, budget, 14, **changes)
    assert asked != offline_queries(strategy, budget, 14)
    assert robot.said('episode')[-1].items() >= changes.items()
    assert robot.said('learner_state')[-1]['kernel']['amplitude'] == changes.get('amplitude', 100.0)


def test_the_last_markers_show_what_was_believed_in_the_end(make: Callable[..., Robot]) -> None:
    """Otherwise people would see a question that nobody asks any more, or beliefs from before the last answer."""
    robot = make()
    robot.plays()
    shown: BeliefsShown = robot.said('scene_markers')[-1]
    believed = robot.said('learner_state')[-1]['beliefs']
    assert (shown.question, shown.asked) == ('', None)
    assert [list(q.values()) for q in believed.values()] == [
        [round(q, 6) for q in row] for row in shown.beliefs.tolist()
    ]
    assert list(believed) == [str(i) for i in shown.scene.object_ids]


def test_a_turn_tells_its_story_in_order(make: Callable[..., Robot]) -> None:
    """Otherwise a teacher would hear of an acknowledgement before it is safe, or markers would hold up the question."""
    robot = make()
    robot.sees()
    assert robot.order == ['turn', 'episode', 'query', 'decision', 'scene_markers']
    robot.is_taught()
    told = ['answer_ack', 'learner_state', 'turn', 'scene_markers', 'concepts']
    assert robot.order[5:] == told
    made: DecisionMade = robot.said('decision')[0]
    shown: list[BeliefsShown] = robot.said('scene_markers')
    query = robot.said('query')[0]
    assert {one.stamp for one in (made, *shown)} == {stamp_of(robot.said('turn')[0]['stamp'])}
    assert {one.frame_id for one in (made, *shown)} == {'table'}
    assert [one.question for one in shown] == [query['text'], '']
    assert robot.said('episode')[0]['feature_names'] == list(made.scene.feature_names)
    assert query['world'] == WORLD


def test_what_is_not_served_is_said_again(make: Callable[..., Robot]) -> None:
    """Otherwise one lost message would stall the episode for ever."""
    robot = make()
    robot.driver.pass_until(7.0)
    assert [turn['turn'] for turn in robot.said('turn')] == [1, 1, 1]
    assert len({stamp_of(turn['stamp']) for turn in robot.said('turn')}) == 1
    robot.sees()
    robot.driver.pass_until(20.0)
    assert len(robot.said('turn')) == 3
    assert [query['query_id'] for query in robot.said('query')] == ['q1', 'q1', 'q1']


def test_one_scene_a_turn_is_looked_at(make: Callable[..., Robot]) -> None:
    """Otherwise a camera's next frame would be taken for another turn while the question is open."""
    robot = make()
    robot.sees()
    before = len(robot.driver.done)
    robot.sees()
    assert len(robot.driver.done) == before


def test_scenes_from_before_the_turn_are_passed_over_and_after_a_while_told_of(make: Callable[..., Robot]) -> None:
    """Otherwise what the robot saw before it moved would be learnt, or a wrong clock be ignored in silence."""
    robot = make()
    for seconds in (0.0, 1.0, 2.0):
        robot.driver.seconds = seconds
        robot.sees(stamp=5 * SECOND)
    assert robot.driver.refusals == []
    robot.driver.seconds = 4.0
    robot.sees(stamp=5 * SECOND)
    ((topic, reason),) = robot.driver.refusals
    assert topic == 'objects'
    assert 'is the clock of their sender behind?' in reason
    assert robot.said('query') == []
    robot.sees()
    assert len(robot.said('query')) == 1


def test_a_turn_does_not_wait_for_ever_for_its_answer(make: Callable[..., Robot]) -> None:
    """A teacher who has gone does not stall the robot; the longer they are away, the longer it waits each time."""
    robot = make(answer_timeout=3.0, settings=episode_settings(TASK, 'u_sampling', 6.0, 100, change_interval=100))
    waits = []
    for missed in range(6):
        robot.sees()
        warning = f'nobody has answered for {missed} turn{"" if missed == 1 else "s"}'
        assert robot.machine.warning(robot.driver.now) == (warning if missed else '')
        waits.append(robot.driver.timers[ANSWER_TIMEOUT] - robot.driver.seconds)
        robot.driver.pass_until(robot.driver.timers[ANSWER_TIMEOUT])
    assert waits == [3.0 * min(2**missed, LONGEST_BACK_OFF) for missed in range(6)]
    assert len({json.dumps(query) for query in robot.said('query')}) == 1
    assert robot.driver.lines[1] == 'turn 1: going on without the answer to q1'
    robot.sees()
    robot.is_taught()
    assert robot.said('answer_ack')[-1]['accepted']
    assert robot.machine.warning(robot.driver.now) == ''
    # Neither its question nor its answer is waited for any more, nor is the state of the turn before of use.
    assert set(robot.driver.timers) == {'repeat turn'}


def test_turns_are_paced(make: Callable[..., Robot]) -> None:
    """Otherwise `turn_period` would be ignored, and a person could not follow."""
    robot = make(turn_period=5.0)
    for at, turns in ((0.5, 1), (4.9, 1), (5.0, 2)):
        robot.driver.pass_until(at)
        if at == 0.5:
            robot.sees()
            robot.is_taught()
        assert len(robot.said('turn')) == turns
    robot.driver.pass_until(6.0)
    robot.sees()
    robot.driver.pass_until(15.0)
    robot.is_taught()
    assert robot.said('turn')[-1]['turn'] == 3


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('pudding', "'pudding' does not answer"),
        ('{"schema"', 'JSON'),
        (documents.write('answer', 'e2', {
            'query_id': 'q1', 'answer_id': 'a', 'teacher_id': 't', 'outcome': 'skip', 'content': None
        }), 'belongs to episode e2'),
    ],
)  # fmt: skip
def test_what_is_no_answer_is_refused_with_a_reason(
    make: Callable[..., Robot], tmp_path: Path, text: str, reason: str
) -> None:
    """Otherwise a person would wait for nothing, or another robot's answer be learnt."""
    robot = make(tmp_path)
    robot.sees()
    robot.driver.hear('answer', text)
    (ack,) = robot.said('answer_ack')
    assert not ack['accepted']
    assert reason in ack['reason']
    assert robot.driver.refusals == [('answer', ack['reason'])]
    robot.is_taught()
    assert robot.said('answer_ack')[-1]['accepted']
    robot.machine.close()
    rejected = [event for event in events(tmp_path) if isinstance(event, InputRejected)]
    assert [one.text for one in rejected] == [text]


def test_a_plain_word_is_an_answer(make: Callable[..., Robot]) -> None:
    """A person with nothing but `ros2 topic pub` could not teach."""
    robot = make(settings=episode_settings(TASK, 'u_sampling', 6.0, 8))
    robot.driver.hear('answer', 'snack')
    assert 'no query is pending' in robot.driver.refusals[0][1]
    robot.sees()
    robot.driver.hear('answer', 'snack')
    assert robot.said('learner_state')[-1]['queries'][0]['symbol'] == 'snack'
    assert robot.driver.lines[-1] == 'q1: plain says snack'


@pytest.mark.parametrize('question_is_open', [True, False])
def test_a_correction_is_learnt_outside_of_the_turns(make: Callable[..., Robot], question_is_open: bool) -> None:
    """Otherwise a slip would stay in what the robot knows, or the present turn would end, or begin once more."""
    robot = make(settings=episode_settings(TASK, 'u_sampling', 6.0, 8))
    robot.sees()
    first = robot.is_taught()
    if question_is_open:
        robot.sees()
    turns = len(robot.said('turn'))
    other = 'snack' if first['content'] != 'snack' else 'fruit'
    correction = {**first, 'answer_id': 'q1/other', 'content': other, 'replaces': first['answer_id']}
    robot.driver.hear_document('answer', 'e1', correction)
    assert robot.said('answer_ack')[-1]['accepted']
    assert robot.said('learner_state')[-1]['queries'][0]['symbol'] == other
    assert robot.driver.lines[-1] == f'q1: {first["teacher_id"]} now says {other}'
    assert len(robot.said('turn')) == turns
    assert ('repeat query' in robot.driver.timers) == question_is_open


def test_what_is_said_before_it_has_begun_is_not_answered(world: PerceivedWorld) -> None:
    """Otherwise a learner that goes through a long session would refuse the answer to its own question."""
    robot = Robot(world, None, SETTINGS, LearnerOptions())
    robot.driver.hear('answer', 'snack')
    assert robot.driver.done == []


def other_turn(robot: Robot) -> None:
    """Another learner begins a turn on the same topics."""
    members = {'turn': 1, 'stamp': {'sec': 1, 'nanosec': 0}, 'world': None}
    robot.driver.hear_document('turn', 'another', members)


def test_another_learner_is_warned_of_for_a_while(make: Callable[..., Robot]) -> None:
    """Otherwise nobody would know why two robots mistake each other."""
    robot = make()
    robot.driver.hear('turn', documents.write('turn', 'e1', {
        'turn': 1, 'stamp': {'sec': 1, 'nanosec': 0}, 'world': None,
    }))  # fmt: skip
    assert robot.machine.warning(robot.driver.now) == ''
    other_turn(robot)
    assert 'another learner publishes turn' in robot.machine.warning(robot.driver.now)
    assert robot.machine.warning(Moment(steady=61.0)) == ''
    assert robot.driver.effects(End) == []


@pytest.mark.parametrize('yields', [True, False])
def test_a_learner_that_is_over_makes_room_if_it_is_to(make: Callable[..., Robot], yields: bool) -> None:
    """Otherwise a page would go on to show the end of the old episode, or a robot's process end by chance."""
    robot = make(settings=dataclasses.replace(SETTINGS, turns=1, budget=0.0), yields=yields)
    robot.sees()
    assert robot.said('learner_state')[-1]['done']
    other_turn(robot)
    assert len(robot.driver.effects(End)) == yields
    assert robot.machine.warning(robot.driver.now) == ''


def test_a_session_goes_on_with_the_same_question(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a crash would cost a question, or what was learnt."""
    robot = make(tmp_path)
    robot.sees()
    robot.is_taught()
    robot.sees()
    robot.machine.close()
    again = make(tmp_path, origin='the log')
    assert again.driver.lines[0] == 'going on with e1, in turn 2, from the log'
    assert again.order == ['episode', 'turn', 'query', 'decision', 'scene_markers', 'concepts']
    assert again.said('query') == robot.said('query')[-1:]
    assert again.said('turn') == robot.said('turn')[-1:]
    before = stamp_of(robot.said('turn')[-1]['stamp'])
    again.is_taught()
    assert stamp_of(again.said('turn')[-1]['stamp']) > before
    assert [query['turn'] for query in again.said('learner_state')[-1]['queries']] == [1, 2]
    assert again.said('turn')[-1]['turn'] == 3
    again.machine.close()


@pytest.mark.parametrize('event', ['a scene', 'an answer'])
def test_a_session_that_cannot_be_written_ends_the_questions(
    make: Callable[..., Robot], tmp_path: Path, event: str
) -> None:
    """Otherwise an answer would be acknowledged that is nowhere, or a question asked that nobody may answer."""
    robot = make(tmp_path, answer_timeout=3.0)
    if event == 'an answer':
        robot.sees()
    robot.durable._log._storage._database.execute('PRAGMA query_only=1')
    with pytest.raises(EpisodeError, match='cannot be written'):
        robot.sees() if event == 'a scene' else robot.is_taught()
    assert robot.said('answer_ack') == []
    assert robot.driver.timers == {}
    before = list(robot.order)
    robot.sees()
    assert robot.order == before
    robot.machine.close()


def test_what_is_known_already_is_told_with_its_doubts(make: Callable[..., Robot]) -> None:
    """Otherwise a person would not know what the robot begins with."""
    robot = make(notes=('knows two names', 'one looks like the other'))
    assert robot.driver.effects(Say) == [
        Say('knows two names'), Say('one looks like the other', Level.WARNING),
    ]  # fmt: skip


def test_what_it_waits_for_is_reported(make: Callable[..., Robot]) -> None:
    """Otherwise nobody would see on /diagnostics what the robot waits for."""
    robot = make()
    report = robot.driver.effects(Report)[-1]
    assert (report.activity, report.awaited) == ('turn 1: waiting for objects', 'objects')
    robot.sees()
    assert robot.driver.effects(Report)[-1] == Report('turn 1: waiting for the answer to q1', 60.0)


def test_without_a_timeout_a_turn_waits_for_its_answer(make: Callable[..., Robot]) -> None:
    """Otherwise a teacher who thinks for an hour would find the question gone."""
    robot = make(answer_timeout=0.0)
    robot.sees()
    robot.driver.pass_until(3600.0)
    assert len(robot.said('turn')) == 1
    robot.is_taught()
    assert len(robot.said('turn')) == 2


def test_a_file_of_concepts_is_written_after_each_answer(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a recogniser that reads it would not know what was learnt."""
    robot = make(concepts_files=[tmp_path / 'concepts.json'])
    for answers in (1, 2):
        robot.sees()
        robot.is_taught()
        written = robot.driver.effects(WriteFile)
        assert len(written) == answers
        assert json.loads(written[-1].text) == robot.said('concepts')[-1]


def test_all_that_is_wrong_around_a_learner_is_warned_of(make: Callable[..., Robot], tmp_path: Path) -> None:
    """Otherwise a file that lags behind would be hidden by another warning, or hide it."""
    (tmp_path / 'file').write_text('', encoding='utf-8')

    def write(effect: Effect) -> None:
        if isinstance(effect, WriteFile):
            write_text(effect.path, effect.text)

    robot = make(do=write, answer_timeout=3.0, concepts_files=[tmp_path / 'file' / 'concepts.json'])
    robot.sees()
    robot.driver.pass_until(3.0)
    other_turn(robot)
    rival, absence, file = robot.machine.warning(robot.driver.now).split('; ')
    assert 'another learner' in rival
    assert absence == 'nobody has answered for 1 turn'
    assert str(tmp_path / 'file') in file
    (tmp_path / 'file').unlink()
    (tmp_path / 'file').mkdir()
    robot.is_taught()
    assert robot.machine.warning(Moment(steady=100.0)) == ''
