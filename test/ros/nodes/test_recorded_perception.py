"""A live learner that is shown the scenes of a bag in place of perception."""

from __future__ import annotations

from typing import Any

from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.bags import deserialize, read_bag
from al_questioner.bags.scenes import scenes_of
from al_questioner.messages import documents
from al_questioner.messages.stamps import SECOND, nanoseconds
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.recorded_perception import RecordedPerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.bags import SHIPPED, recorded
from shared.offline import offline_queries


def stand_in(graph: Any) -> RecordedPerceptionNode:
    return graph.start(lambda **node_arguments: RecordedPerceptionNode(scenes_of(read_bag(SHIPPED)), **node_arguments))


def test_a_second_learner_asks_what_it_would_have_asked_in_the_recorded_world(graph: Any) -> None:
    """Otherwise it would miss scenes, or the teacher would answer about other things."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    world = {'task': 'prepare_lunch', 'seed': 0}
    stand_in(graph)
    graph.start(TeacherNode, **world)
    graph.start(LearnerNode, **world, strategy='farthest_fsq', budget=12.0, turns=20)
    state = graph.wait_for_end(states)
    assert state['queries'] == offline_queries('farthest_fsq', 12.0, 20, seed=0)
    assert state['spent'] > 0


def test_two_perceptions_are_one_too_many(graph: Any) -> None:
    """Otherwise a learner would see the recorded scene in one turn and another one in the next."""
    node = stand_in(graph)
    graph.start(PerceptionNode, **graph.world)
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert f'/{graph.namespace}/perception shows objects, too' in str(node.failure)


def test_other_turns_than_the_recorded_ones_are_refused_with_their_number(graph: Any) -> None:
    """Otherwise a learner with more turns than the bag would wait without a word."""
    node = stand_in(graph)
    clouds = graph.listen('objects', PointCloud2)
    turns = node.create_publisher(String, 'turn', qos.LATCHED)
    members = {'stamp': {'sec': 2_000_000_000, 'nanosec': 7}, 'world': None}
    turns.publish(String(data=documents.write('turn', 'e', {'turn': 31, **members})))
    graph.wait_for(lambda: node.counts().get('refused on turn') == 1, 'a refusal')
    assert not clouds
    turns.publish(String(data=documents.write('turn', 'e', {'turn': 30, **members})))
    graph.wait_for(lambda: clouds, 'the last recorded scene')
    last = deserialize(recorded('objects')[-1])
    assert bytes(clouds[0].data) == last.data.tobytes()
    assert clouds[0].header.frame_id == last.header.frame_id
    assert nanoseconds(clouds[0].header.stamp) == 2_000_000_000 * SECOND + 7
