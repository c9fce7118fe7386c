"""What a person, or a camera, may send the learner, usable and unusable."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
from diagnostic_msgs.msg import DiagnosticArray
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode


class Person:
    """Somebody with `ros2 topic pub`, `ros2 topic echo` and patience."""

    def __init__(self, graph: Any) -> None:
        self.graph = graph
        self.queries = graph.listen('query')
        self.acks = graph.listen('answer_ack', profile=qos.EVENTS)
        self.mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)

    def query(self, number: int) -> dict[str, Any]:
        """The query of this number, once it is asked."""
        self.graph.wait_for(lambda: self.queries and self.queries[-1]['query_id'] == f'q{number}', f'query {number}')
        return self.queries[-1]

    def says(self, text: str) -> dict[str, Any]:
        """Say something, and hear whether it was taken."""
        before = len(self.acks)
        self.graph.wait_for(lambda: self.mouth.get_subscription_count(), 'a learner that listens')
        self.mouth.publish(String(data=text))
        self.graph.wait_for(lambda: len(self.acks) > before, f'an acknowledgement of {text[:40]!r}')
        return self.acks[-1]


def answer(query: dict[str, Any], content: Any, **changes: Any) -> str:
    document = {
        'schema': 'al_questioner/answer/1',
        'episode_id': query['episode_id'],
        'query_id': query['query_id'],
        'answer_id': 'a1',
        'teacher_id': 'anna',
        'outcome': 'answered',
        'content': content,
        **changes,
    }
    return json.dumps(document)


PLAIN = {'label': 'snack', 'demonstration': 'none', 'feature_subset': 'colour,size'}


def test_plain_words_teach(graph: Any) -> None:
    """A person with nothing but `ros2 topic pub` could not answer."""
    states = graph.listen('learner_state')
    person = Person(graph)
    graph.start_robot(budget=5.0, turns=4, strategy='random_fsq')
    for number in (1, 2, 3):
        query = person.query(number)
        assert person.says(PLAIN[query['kind']])['accepted']
    graph.wait_for(lambda: states and len(states[-1]['queries']) == 3, 'three answered queries')
    assert {query['outcome'] for query in states[-1]['queries']} == {'answered'}


def test_unusable_answers_are_refused_and_the_question_stays(graph: Any) -> None:
    """Nonsense would be learnt, the question lost, or the node ended."""
    states = graph.listen('learner_state')
    person = Person(graph)
    diagnostics = graph.listen('diagnostics', DiagnosticArray, qos.DIAGNOSTICS, '/diagnostics')
    graph.start_robot(strategy='u_sampling', turns=3)
    query = person.query(1)
    refused = {
        'pudding': 'does not answer',
        '': 'does not answer',
        '{"schema"': 'not valid JSON',
        answer(query, 'pudding'): 'unknown label',
        answer(query, 3): 'a label is one of',
        answer(query, None): 'a label is one of',
        answer(query, 'snack', query_id='q9'): "'q9'",
        answer(query, 'snack', episode_id='another'): 'episode another',
        answer(query, 'snack', outcome='unknown'): 'no content',
        answer(query, 'snack', schema='al_questioner/answer/7'): 'schema',
    }
    for text, reason in refused.items():
        ack = person.says(text)
        assert not ack['accepted'], text
        assert reason in ack['reason']
    assert not states
    assert person.says(answer(query, 'snack'))['accepted']
    assert person.says(answer(query, 'snack'))['reason'] == 'already taken'
    assert not person.says(answer(query, 'fruit'))['accepted']
    graph.wait_for(lambda: states and len(states[-1]['queries']) == 1, 'the answered query')
    assert states[-1]['labels']['snack'] == 1

    def shown() -> bool:
        values = [value for array in diagnostics for status in array.status for value in status.values]
        return any(value.key == 'refused on answer' and value.value == '11' for value in values)

    graph.wait_for(shown, 'the number of refusals on /diagnostics')


def test_demonstration_of_an_object_that_has_gone_is_refused(graph: Any) -> None:
    """A label would be attached to features that nobody named."""
    person = Person(graph)
    graph.start_robot(strategy='rarest_demo', turns=4)
    query = person.query(1)
    number = 1
    while query['kind'] != 'demonstration':
        assert person.says(PLAIN[query['kind']])['accepted']
        number += 1
        query = person.query(number)
    ack = person.says(answer(query, 9999))
    assert not ack['accepted']
    assert 'object 9999 is not in the scene' in ack['reason']
    assert person.says(answer(query, int(query['choices'][0])))['accepted']


def test_unusable_scenes_are_refused_and_the_turn_goes_on(graph: Any) -> None:
    """One bad frame of a camera would end the episode, or be learnt from."""
    person = Person(graph)
    turns = graph.listen('turn')
    clouds = graph.listen('objects', PointCloud2)
    diagnostics = graph.listen('diagnostics', DiagnosticArray, qos.DIAGNOSTICS, '/diagnostics')
    perception = graph.start(PerceptionNode, **graph.world)
    learner = graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: clouds and turns, 'a scene')
    cloud = clouds[-1]
    graph.stop(perception)
    graph.stop(learner)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    learner = graph.start(LearnerNode, **graph.episode)

    def tells(documents: list[dict[str, Any]]) -> bool:
        # Of the first learner there may still be something under way.
        return any(document['episode_id'] == learner.episode_id for document in documents)

    graph.wait_for(lambda: tells(turns), 'the first turn')
    graph.wait_for(lambda: eyes.get_subscription_count() > 1, 'a learner that looks')
    cloud.header.stamp.sec += 3600
    good = bytes(cloud.data)
    damaged = bytearray(good)
    damaged[16:20] = np.float32(np.nan).tobytes()
    for data, reason in ((bytes(damaged), 'not finite'), (good[:-1], 'too few')):
        cloud.data = data
        eyes.publish(cloud)
        graph.wait_for(
            lambda reason=reason: any(reason in s.message for array in diagnostics for s in array.status), reason
        )
    assert not tells(person.queries)
    cloud.data = good
    eyes.publish(cloud)
    graph.wait_for(lambda: tells(person.queries), 'a question')
