"""A learner with a session log: what is acknowledged is on the disk, and a new learner goes on from there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import String

from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import AnswerAccepted, InputRejected, LateAnswerKept
from al_questioner.event_log.log import SessionLogError, read_log
from al_questioner.messages.stamps import stamp_of
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from shared.offline import offline_queries

EPISODE = {'task': 'prepare_lunch', 'seed': 4, 'budget': 6.0, 'turns': 5, 'strategy': 'u_sampling'}


def told(folder: Path, kind: type = AnswerAccepted) -> list[Any]:
    found, fault = decoded(read_log(folder))
    assert fault is None
    return [event for event in found if isinstance(event, kind)]


def test_an_acknowledged_answer_is_on_the_disk(graph: Any, person: Any, tmp_path: Path) -> None:
    """Otherwise an answer would be lost whose teacher was told that it was taken."""
    graph.start_robot(**EPISODE, session=str(tmp_path / 'log'))
    query = person.query(1)
    assert not person.answers(query, 'pudding')['accepted']
    assert person.answers(query, 'snack')['accepted']
    assert [event.answer.content for event in told(tmp_path / 'log')] == ['snack']
    assert [event.reason[:13] for event in told(tmp_path / 'log', InputRejected)] == ['unknown label']


def test_a_new_learner_goes_on_where_the_last_one_ended(graph: Any, person: Any, tmp_path: Path) -> None:
    """After a crash the episode does not start over, and the pending question is neither lost nor another one."""
    graph.start(PerceptionNode, **graph.world)
    parameters = {**EPISODE, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters)
    assert person.answers(person.query(1), 'snack')['accepted']
    pending = person.query(2)
    graph.wait_for(lambda: person.turns and person.turns[-1]['turn'] == 2, 'both turns')
    graph.stop(learner)
    asked, begun = len(person.queries), len(person.turns)
    learner = graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: len(person.queries) > asked and len(person.turns) > begun, 'the question once more')
    graph.wait_for(lambda: learner.machine._durable.is_ready, 'a learner that takes answers')
    assert person.queries[-1] == pending
    assert person.turns[begun] == person.turns[begun - 1]
    assert person.answers(person.queries[0], 'snack')['reason'] == 'already taken'
    assert person.answers(pending, 'fruit')['accepted']
    person.query(3)
    graph.wait_for(lambda: person.states and len(person.states[-1]['queries']) == 2, 'two answers')
    assert person.states[-1]['episode_id'] == pending['episode_id']
    stamps = [stamp_of(turn['stamp']) for turn in person.turns]
    assert stamps == sorted(stamps)


def test_a_learner_that_ended_between_turns_goes_on(graph: Any, person: Any, tmp_path: Path) -> None:
    """Otherwise a learner that is stopped between two turns would wait for ever."""
    graph.start(PerceptionNode, **graph.world)
    parameters = {**EPISODE, 'turns': 2, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters, turn_period=3000.0)
    assert person.answers(person.query(1), 'snack')['accepted']
    graph.wait_for(lambda: person.states, 'the end of turn 1')
    graph.stop(learner)
    learner = graph.start(LearnerNode, **parameters)
    assert person.answers(person.query(2), 'snack')['accepted']
    graph.wait_for(lambda: person.states[-1]['done'], 'the end')
    graph.stop(learner)
    before = len(person.states)
    graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: len(person.states) > before, 'the state of an episode that is over')
    assert person.states[-1] == person.states[before - 1]
    graph.wait_for(lambda: person.turns and person.turns[-1]['turn'] == 2, 'the second turn')
    assert {turn['turn'] for turn in person.turns} == {1, 2}


def test_a_late_answer_is_refused_and_kept(graph: Any, person: Any, tmp_path: Path) -> None:
    """Otherwise the second of two teachers would label what is asked about now with what was asked before."""
    graph.start_robot(**EPISODE, session=str(tmp_path / 'log'))
    query = person.query(1)
    person.answers(query, 'snack')
    person.query(2)
    for _ in range(2):
        ack = person.answers(query, 'fruit', answer_id='b1', teacher_id='bert')
        assert (ack['accepted'], ack['answer_id']) == (False, 'b1')
        assert "query 'q1' was answered already, by 'a1'" in ack['reason']
    graph.wait_for(
        lambda: person.states and 'bert' in person.states[-1]['teachers'], 'a state that tells of the late teacher'
    )
    state = person.states[-1]
    assert (state['turn'], state['teachers']['bert']['late'], state['labels']['fruit']) == (1, 1, 0)
    assert [event.answer.teacher_id for event in told(tmp_path / 'log', LateAnswerKept)] == ['bert']
    assert told(tmp_path / 'log', InputRejected) == []


@pytest.mark.parametrize('with_log', [True, False])
def test_a_correction_changes_what_is_known_and_not_what_is_asked(
    graph: Any, person: Any, tmp_path: Path, with_log: bool
) -> None:
    """Otherwise a person who was wrong could not take it back."""
    graph.start_robot(**EPISODE, session=str(tmp_path / 'log') if with_log else '')
    query = person.query(1)
    person.answers(query, 'snack')
    person.query(2)
    graph.wait_for(lambda: person.states and person.states[-1]['turn'] == 1, 'the end of turn 1')
    for reason in ('', 'already taken'):
        ack = person.answers(query, 'fruit', answer_id='a2', replaces='a1')
        assert (ack['accepted'], ack['reason']) == (True, reason)
    graph.wait_for(lambda: person.states[-1]['labels']['fruit'] == 1, 'what is known now')
    assert person.states[-1]['turn'] == 1
    assert person.states[-1]['labels']['snack'] == 0
    assert person.states[-1]['spent'] == 1.0
    assert person.answers(query, None, outcome='skip', answer_id='a3', replaces='a2')['accepted']
    graph.wait_for(lambda: person.states[-1]['queries'][0]['outcome'] == 'skip', 'nothing known')
    assert sum(person.states[-1]['labels'].values()) == 0
    ack = person.answers(query, 'fruit', answer_id='a4', replaces='a9')
    assert (ack['accepted'], ack['reason']) == (False, "no answer 'a9' to query 'q1' was taken")
    assert {query['query_id'] for query in person.queries} == {'q1', 'q2'}
    assert person.answers(person.queries[-1], 'snack')['accepted']


def test_a_disk_that_takes_no_more_stops_the_questions(
    graph: Any, person: Any, diagnostics: Any, tmp_path: Path
) -> None:
    """Otherwise an answer would be acknowledged that is nowhere, and nobody would know why nothing goes on."""
    graph.start(PerceptionNode, **graph.world)
    parameters = {**EPISODE, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters)
    person.answers(person.query(1), 'snack')
    query = person.query(2)
    learner.machine._durable._log._storage._database.execute('PRAGMA query_only=1')
    acks = len(person.acks)
    person.mouth.publish(String(data='snack'))
    diagnostics.wait_for('session log cannot be written', DiagnosticStatus.ERROR)
    assert len(person.acks) == acks
    assert {query['query_id'] for query in person.queries} == {'q1', 'q2'}
    assert learner.machine._question.message is None
    graph.stop(learner)
    asked = len(person.queries)
    learner = graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: len(person.queries) > asked, 'the question once more')
    graph.wait_for(lambda: learner.machine._durable.is_ready, 'a learner that takes answers')
    assert person.answers(query, 'snack')['accepted']
    assert len(told(tmp_path / 'log')) == 2


def test_a_session_belongs_to_one_learner_and_one_episode(graph: Any, tmp_path: Path) -> None:
    """Otherwise two learners, or two episodes, would be mixed in one log."""
    parameters = {**EPISODE, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: learner.machine._durable.is_ready, 'a learner that has begun')
    with pytest.raises(SessionLogError, match='another process is using this session'):
        graph.start(LearnerNode, **parameters)
    graph.stop(learner)
    with pytest.raises(SessionLogError, match=r'the session there has budget 6\.0, not 7\.0; turns 5, not 9'):
        graph.start(LearnerNode, **{**parameters, 'budget': 7.0, 'turns': 9})
    graph.start(LearnerNode, **parameters)


def test_the_scripted_teacher_and_a_session_play_the_episode(graph: Any, tmp_path: Path) -> None:
    """Otherwise the log would change what is asked."""
    queries = graph.play(session=str(tmp_path / 'log'))['queries']
    assert queries == offline_queries('random_fsq', 6.0, 8)


def test_a_learner_tells_that_another_version_began_its_session(
    graph: Any, person: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Otherwise nobody would know why from some turn on it asks in another way."""
    graph.start(PerceptionNode, **graph.world)
    parameters = {**EPISODE, 'session': str(tmp_path / 'log')}
    learner = graph.start(LearnerNode, **parameters)
    assert person.answers(person.query(1), 'snack')['accepted']
    graph.stop(learner)
    monkeypatch.setattr('al_questioner.protocol.learner.SEMANTICS', 99)
    learner = graph.start(LearnerNode, **parameters)
    graph.wait_for(lambda: learner.machine._durable.is_ready, 'a learner that goes on')
    printed: list[str] = []

    def is_told() -> bool:
        printed.append(capfd.readouterr().err)
        return 'another version of the method began this session' in ''.join(printed)

    graph.wait_for(is_told, 'the warning')
