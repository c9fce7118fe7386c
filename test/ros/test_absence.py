"""A teacher who is away: the learner goes on without, says so, and takes the answer whenever it comes."""

from __future__ import annotations

from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from std_msgs.msg import String

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode

SOON = 0.05
"""Seconds after which the learner of these tests believes that nobody is there."""


@pytest.fixture
def start(graph: Any) -> Any:
    """Starts a robot whose teacher is away, and hears what it publishes."""

    def make(**learner: Any) -> dict[str, list[Any]]:
        heard = {name: graph.listen(name) for name in ('query', 'learner_state')}
        heard['ack'] = graph.listen('answer_ack', profile=qos.EVENTS)
        heard['diagnostics'] = graph.listen('/diagnostics', DiagnosticArray, qos.DIAGNOSTICS)
        graph.start(PerceptionNode, **graph.world)
        parameters = {'strategy': 'u_sampling', 'budget': 4.0, 'turns': 5, 'answer_timeout': SOON, **learner}
        graph.start(LearnerNode, **{**graph.episode, **parameters})
        return heard

    return make


def test_an_episode_without_a_teacher_comes_to_its_end(graph: Any, start: Any) -> None:
    """A teacher who never comes would stall the episode; a label would be guessed, or budget taken for nothing."""
    heard = start()
    graph.wait_for(lambda: heard['learner_state'] and heard['learner_state'][-1]['done'], 'the end')
    state = heard['learner_state'][-1]
    assert (state['turn'], state['spent'], sum(state['labels'].values())) == (5, 0.0, 0)
    assert [query['outcome'] for query in state['queries']] == ['unanswered'] * len(state['queries'])
    graph.wait_for(lambda: heard['query'], 'a question')


def test_the_question_is_asked_again_word_for_word_and_answered_late(graph: Any, start: Any) -> None:
    """Somebody who comes back would find no question, or another one; what they say would be refused."""
    heard = start(turns=1000, change_interval=1000)
    graph.wait_for(lambda: len(heard['query']) > 2, 'the question once more')
    first = heard['query'][0]
    assert all(query == first for query in heard['query'])
    graph.start(TeacherNode, **graph.world)
    graph.wait_for(lambda: any(ack['accepted'] for ack in heard['ack']), 'an answer that is taken')
    graph.wait_for(lambda: heard['learner_state'] and heard['learner_state'][-1]['queries'], 'the answer in the state')
    told = heard['learner_state'][-1]['queries'][0]
    assert (told['turn'], told['object_id'], told['outcome']) == (1, first['object_id'], 'answered')
    assert told['answered_in'] > 1
    graph.wait_for(lambda: heard['query'][-1]['query_id'] != first['query_id'], 'another question')


def test_the_absence_is_a_warning(graph: Any, start: Any) -> None:
    """Nobody would see that the robot waits for somebody."""
    heard = start(turns=1000)

    def warned() -> list[str]:
        statuses = [status for array in heard['diagnostics'] for status in array.status]
        return [s.message for s in statuses if s.level == DiagnosticStatus.WARN and 'nobody has answered' in s.message]

    graph.wait_for(warned, 'a warning')


def test_without_a_timeout_the_learner_waits(graph: Any, start: Any) -> None:
    """A person who needs time to think would be passed over although the configuration says otherwise."""
    heard = start(answer_timeout=0.0)
    query = graph.wait_for(lambda: heard['query'], 'a question')[0]
    mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    graph.wait_for(mouth.get_subscription_count, 'a learner that listens')
    # Many times the timeout of the other tests, counted in acknowledgements.
    for number in range(20):
        mouth.publish(String(data='pudding'))
        graph.wait_for(lambda at=number: len(heard['ack']) > at, 'a refusal')
    assert all(other == query for other in heard['query'])
    assert not heard['learner_state']


def test_a_session_remembers_that_nobody_answered(graph: Any, start: Any, tmp_path: Any) -> None:
    """A learner that is started again would begin the turns anew that had passed."""
    log = str(tmp_path / 'log')
    heard = start(turns=1000, session=log, change_interval=1000)
    graph.wait_for(lambda: heard['learner_state'] and heard['learner_state'][-1]['turn'] > 1, 'two turns that passed')
    graph.wait_for(lambda: heard['query'], 'the question')
    graph.stop(graph.nodes[-1])
    passed, asked = heard['learner_state'][-1]['turn'], heard['query'][-1]
    again = {'strategy': 'u_sampling', 'budget': 4.0, 'turns': 1000, 'change_interval': 1000}
    # It waits now, so that nothing but the answer can end the turn.
    graph.start(LearnerNode, **{**graph.episode, **again, 'answer_timeout': 0.0, 'session': log})
    mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    graph.wait_for(mouth.get_subscription_count, 'a learner that listens')
    graph.start(TeacherNode, **graph.world)
    graph.wait_for(lambda: heard['learner_state'][-1]['queries'], 'the answer in the state')
    state = heard['learner_state'][-1]
    assert state['queries'][0]['turn'] == asked['turn'] <= passed <= state['queries'][0]['answered_in']
    assert state['teachers']['scripted']['answered'] >= 1


def test_an_answer_between_the_turns_begins_no_turn_of_its_own(graph: Any, start: Any) -> None:
    """Two turns would begin at once, and the robot look at one scene for two."""
    turns = graph.listen('turn')
    heard = start(turns=3, turn_period=3000.0, change_interval=1000)
    graph.wait_for(lambda: heard['learner_state'] and turns, 'the first turn and its end')
    mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    graph.wait_for(mouth.get_subscription_count, 'a learner that listens')
    mouth.publish(String(data='snack'))
    graph.wait_for(lambda: heard['learner_state'][-1]['queries'], 'the answer in the state')
    graph.wait_for(lambda: heard['ack'], 'the acknowledgement')
    assert heard['ack'][-1]['accepted']
    assert {turn['turn'] for turn in turns} == {1}
    assert heard['learner_state'][-1]['turn'] == 1
