"""Usable and unusable messages of a person, or a camera, to the learner."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.durable_sessions import ask_what_matters

PLAIN = {'label': 'snack', 'demonstration': 'none', 'feature_subset': 'colour,size'}


def test_plain_words_teach(graph: Any, person: Any) -> None:
    """Otherwise a person with nothing but `ros2 topic pub` could not answer."""
    graph.start_robot(budget=5.0, turns=4, strategy='random_fsq')
    for number in (1, 2, 3):
        query = person.query(number)
        assert person.says(PLAIN[query['kind']])['accepted']
    graph.wait_for(lambda: person.states and len(person.states[-1]['queries']) == 3, 'three answered queries')
    assert {query['outcome'] for query in person.states[-1]['queries']} == {'answered'}


def test_unusable_answers_are_refused_and_the_question_stays(graph: Any, person: Any, diagnostics: Any) -> None:
    """Otherwise nonsense would be learnt, the question lost, or the node ended."""
    graph.start_robot(strategy='u_sampling', turns=3)
    query, document = person.query(1), person.document
    refused = {
        'pudding': 'does not answer',
        '': 'does not answer',
        '{"schema"': 'not valid JSON',
        document(query, 'pudding'): 'unknown label',
        document(query, 3): 'a label is one of',
        document(query, None): 'a label is one of',
        document(query, 'snack', query_id='q9'): "'q9'",
        document(query, 'snack', episode_id='another'): 'episode another',
        document(query, 'snack', outcome='unknown'): 'no content',
        document(query, 'snack', schema='al_questioner/answer/7'): 'schema',
    }
    for text, reason in refused.items():
        ack = person.says(text)
        assert not ack['accepted'], text
        assert reason in ack['reason']
    assert not person.states
    assert person.answers(query, 'snack')['accepted']
    assert person.answers(query, 'snack')['reason'] == 'already taken'
    assert not person.answers(query, 'fruit')['accepted']
    graph.wait_for(lambda: person.states and len(person.states[-1]['queries']) == 1, 'the answered query')
    assert person.states[-1]['labels']['snack'] == 1
    graph.wait_for(lambda: diagnostics.values.get('refused on answer') == '11', 'the number of refusals')


def test_demonstration_of_an_object_that_has_gone_is_refused(graph: Any, person: Any) -> None:
    """Otherwise a label would be attached to features that nobody named."""
    graph.start_robot(strategy='rarest_demo', turns=4)
    query = person.query(1)
    number = 1
    while query['kind'] != 'demonstration':
        assert person.says(PLAIN[query['kind']])['accepted']
        number += 1
        query = person.query(number)
    ack = person.answers(query, 9999)
    assert not ack['accepted']
    assert 'object 9999 is not in the scene' in ack['reason']
    assert person.answers(query, int(query['choices'][0]))['accepted']


def test_unusable_scenes_are_refused_and_the_turn_goes_on(graph: Any, person: Any, diagnostics: Any) -> None:
    """Otherwise one bad frame of a camera would end the episode, or be learnt from."""
    clouds = graph.listen('objects', PointCloud2)
    perception = graph.start(PerceptionNode, **graph.world)
    learner = graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: clouds and person.turns, 'a scene')
    cloud = clouds[-1]
    graph.stop(perception)
    graph.stop(learner)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    learner = graph.start(LearnerNode, **graph.episode)

    def tells(documents: list[dict[str, Any]]) -> bool:
        # Of the first learner there may still be something under way.
        return any(document['episode_id'] == learner.machine.episode_id for document in documents)

    graph.wait_for(lambda: tells(person.turns), 'the first turn')
    graph.wait_for(lambda: eyes.get_subscription_count() > 1, 'a learner that looks')
    cloud.header.stamp.sec += 3600
    good = bytes(cloud.data)
    damaged = bytearray(good)
    damaged[16:20] = np.float32(np.nan).tobytes()
    for data, reason in ((bytes(damaged), 'not finite'), (good[:-1], 'too few')):
        cloud.data = data
        eyes.publish(cloud)
        diagnostics.wait_for(reason)
    assert not tells(person.queries)
    cloud.data = good
    eyes.publish(cloud)
    graph.wait_for(lambda: tells(person.queries), 'a question')


@pytest.fixture
def asks_what_matters(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let learners ask which things matter, where it is not known."""
    monkeypatch.setattr('al_questioner.ros.nodes.learner.make_picker', lambda: ask_what_matters)


@pytest.mark.usefixtures('asks_what_matters')
def test_a_person_says_which_things_matter(graph: Any, person: Any) -> None:
    """Otherwise the question would be of use to the scripted teacher alone."""
    graph.start_robot(strategy='human', cost_relevance=4.0, budget=9.0, turns=2)
    query = person.query(1)
    assert (query['kind'], query['cost'], query['text']) == ('relevance', 4.0, 'Which of these things matter?')
    first, second, *_ = ids = query['choices']
    for text, reason in {
        f'{first},999': "'999' does not answer",
        f'{first},none': 'stands alone',
        'snack': 'does not answer',
        person.document(query, 'none'): 'a list of object ids',
        person.document(query, [999]): 'object 999 is not in the scene',
        person.document(query, ['colour']): 'are object ids',
        person.document(query, [int(first), 'colour']): 'content',
    }.items():
        ack = person.says(text)
        assert not ack['accepted'], text
        assert reason in ack['reason']
    assert person.says(f'{second}, {first}')['accepted']
    graph.wait_for(lambda: person.states and person.states[-1]['queries'], 'the answer in the state')
    state = person.states[-1]
    assert state['queries'][0]['objects'] == [int(second), int(first)]
    assert state['last_answer']['answer']['content'] == [int(second), int(first)]
    said = state['last_answer']['answer']['answer_id']
    correction = person.document(query, [], answer_id='c1', replaces=said)
    assert person.says(correction)['accepted']
    graph.wait_for(lambda: person.states[-1]['queries'][0]['objects'] == [], 'the correction in the state')
    assert len(ids) == 10


@pytest.mark.usefixtures('asks_what_matters')
def test_the_scripted_teacher_errs_as_its_parameters_say(graph: Any) -> None:
    """Of a lunch all things matter, and a teacher who overlooks everything names none."""
    states = graph.listen('learner_state')
    graph.start_robot(strategy='human', cost_relevance=2.0, budget=2.0, turns=1)
    graph.start(TeacherNode, **graph.world, relevance_omission=1.0)
    (record,) = graph.wait_for_end(states)['queries']
    assert (record['kind'], record['outcome'], record['objects']) == ('relevance', 'answered', [])
