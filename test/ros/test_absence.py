"""A teacher who is away: the learner goes on without, says so, and takes the answer whenever it comes."""

from __future__ import annotations

from typing import Any

from diagnostic_msgs.msg import DiagnosticStatus

from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.teacher import TeacherNode

AWAY = {'strategy': 'u_sampling', 'budget': 4.0, 'turns': 1000, 'change_interval': 1000, 'answer_timeout': 0.05}
"""Of a learner who soon believes that nobody is there."""


def test_an_episode_without_a_teacher_comes_to_its_end(graph: Any, person: Any) -> None:
    """A teacher who never comes does not stall the episode; no label is guessed, no budget taken for nothing."""
    graph.start_robot(**{**AWAY, 'turns': 5, 'change_interval': 10})
    state = graph.wait_for_end(person.states)
    assert (state['turn'], state['spent'], sum(state['labels'].values())) == (5, 0.0, 0)
    assert [query['outcome'] for query in state['queries']] == ['unanswered'] * len(state['queries'])
    person.query(1)


def test_the_question_is_asked_again_word_for_word_and_answered_late(graph: Any, person: Any) -> None:
    """Otherwise somebody who comes back would find no question, or another one; what they say would be refused."""
    graph.start_robot(**AWAY)
    graph.wait_for(lambda: len(person.queries) > 2, 'the question once more')
    first = person.queries[0]
    assert all(query == first for query in person.queries)
    graph.start(TeacherNode, **graph.world)
    graph.wait_for(lambda: any(ack['accepted'] for ack in person.acks), 'an answer that is taken')
    told = graph.wait_for(lambda: person.states and person.states[-1]['queries'], 'the answer in the state')[0]
    assert (told['turn'], told['object_id'], told['outcome']) == (1, first['object_id'], 'answered')
    assert told['answered_in'] > 1
    person.query(2)


def test_the_absence_is_a_warning(graph: Any, diagnostics: Any) -> None:
    """Otherwise nobody would see that the robot waits for somebody."""
    graph.start_robot(**AWAY)
    diagnostics.wait_for('nobody has answered', DiagnosticStatus.WARN)


def test_without_a_timeout_the_learner_waits(graph: Any, person: Any) -> None:
    """Otherwise a person who needs time to think would be passed over although the configuration says otherwise."""
    graph.start_robot(**{**AWAY, 'answer_timeout': 0.0})
    query = person.query(1)
    # Many times the timeout of the other tests, counted in acknowledgements.
    for _ in range(20):
        assert not person.says('pudding')['accepted']
    assert all(other == query for other in person.queries)
    assert not person.states


def test_a_session_remembers_that_nobody_answered(graph: Any, person: Any, tmp_path: Any) -> None:
    """A learner that is started again does not repeat the turns that had passed."""
    session = {**AWAY, 'session': str(tmp_path / 'log')}
    graph.start_robot(**session)
    graph.wait_for(lambda: person.states and person.states[-1]['turn'] > 1, 'two turns that passed')
    asked = person.query(1)
    graph.stop(graph.nodes[-1])
    passed = person.states[-1]['turn']
    # It waits now, so that nothing but the answer can end the turn.
    graph.start(LearnerNode, **{**graph.episode, **session, 'answer_timeout': 0.0})
    graph.wait_for(person.mouth.get_subscription_count, 'a learner that listens')
    graph.start(TeacherNode, **graph.world)
    graph.wait_for(lambda: person.states[-1]['queries'], 'the answer in the state')
    state = person.states[-1]
    assert state['queries'][0]['turn'] == asked['turn'] <= passed <= state['queries'][0]['answered_in']
    assert state['teachers']['scripted']['answered'] >= 1


def test_an_answer_between_the_turns_begins_no_turn_of_its_own(graph: Any, person: Any) -> None:
    """Otherwise two turns would begin at once, and the robot look at one scene for two."""
    graph.start_robot(**{**AWAY, 'turns': 3, 'turn_period': 3000.0})
    graph.wait_for(lambda: person.states and person.turns, 'the first turn and its end')
    assert person.says('snack')['accepted']
    graph.wait_for(lambda: person.states[-1]['queries'], 'the answer in the state')
    assert {turn['turn'] for turn in person.turns} == {1}
    assert person.states[-1]['turn'] == 1
