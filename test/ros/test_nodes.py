"""The three nodes together."""

from __future__ import annotations

import threading
from collections import Counter
from typing import Any

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.node import Node
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from al_questioner.domain import DECISION_FEATURES
from al_questioner.messages.clouds import decision_of_cloud, scene_of_cloud
from al_questioner.messages.documents import write
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.simulation import PerceivedWorld, WorldSpec, load_task
from al_questioner.simulation.kitchen.table_image import draw_scene
from shared.offline import offline_queries

TASK = 'prepare_lunch'
SYMBOLS = ('main_dish', 'snack', 'fruit', 'beverage')
DEADLINE = 60.0


@pytest.mark.parametrize('strategy', ['dt_task_env', 'u_sampling_fsq'])
def test_graph_asks_what_an_offline_run_asks(graph: Any, strategy: str) -> None:
    """A result that is found offline holds for the robot."""
    state = graph.play(strategy=strategy, budget=8.0, turns=14)
    assert state['queries'] == offline_queries(strategy, 8.0, 14)
    assert state['spent'] <= 8.0


def test_every_topic_tells_the_same_story(graph: Any) -> None:
    """Otherwise a page, a bag or RViz would show something else than the learner does."""
    heard = {kind: graph.listen(kind) for kind in ('episode', 'turn', 'query', 'learner_state')}
    acks = graph.listen('answer_ack', profile=qos.EVENTS)
    clouds = graph.listen('objects', PointCloud2)
    pictures = graph.listen('scene_image', Image)
    arrays = graph.listen('scene_markers', MarkerArray)
    decisions = graph.listen('decision', PointCloud2, qos.EVENTS)
    graph.start_robot(strategy='dt_task', turns=4)
    query = graph.wait_for(lambda: heard['query'] and heard['query'][-1], 'a query')

    def all_tell_of_its_turn() -> bool:
        turns = [turn['stamp'] for turn in heard['turn'] if turn['turn'] == query['turn']]
        newest = [messages[-1].header.stamp for messages in (clouds, decisions) if messages]
        newest += [marker.header.stamp for array in arrays[-1:] for marker in array.markers[-1:]]
        stamps = [{'sec': stamp.sec, 'nanosec': stamp.nanosec} for stamp in newest]
        # A turn that is not served soon is said again.
        return bool(turns) and stamps == 3 * turns[:1] and bool(pictures and heard['episode'])

    # Messages of different topics arrive in any order.
    graph.wait_for(all_tell_of_its_turn, 'all topics of the turn of the query')
    scene = scene_of_cloud(clouds[-1])
    decision = decision_of_cloud(decisions[-1], SYMBOLS, query['turn'])
    chosen = decision.candidates[decision.chosen]
    assert heard['episode'][-1]['feature_names'] == list(scene.feature_names)
    assert len(decision.candidates) == len(SYMBOLS) + len(scene) + 2
    assert decision.utilities[decision.chosen] == max(decision.utilities)
    weights = heard['episode'][-1]['weights']
    vector = [weights.get(name, 0.0) for name in DECISION_FEATURES]
    np.testing.assert_allclose(decision.features @ vector, decision.utilities, atol=1e-12)
    assert (chosen.kind.value, chosen.object_id, chosen.symbol) == (query['kind'], query['object_id'], query['symbol'])
    assert pictures[-1].encoding == 'rgb8'
    assert len(pictures[-1].data) == pictures[-1].height * pictures[-1].step
    named = Counter(marker.ns for marker in arrays[-1].markers)
    assert named['objects'] == named['beliefs'] == len(scene)
    assert [marker.text for marker in arrays[-1].markers if marker.ns == 'question'] == [query['text']]
    assert not acks


def test_the_turn_does_not_wait_for_the_picture(graph: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise each new scene would hold the learner up, and pictures of scenes long gone would pile up."""
    may_draw = threading.Semaphore(0)
    drawn: list[Any] = []

    def draw_slowly(observations: Any) -> Any:
        drawn.append([observation.object_id for observation in observations])
        may_draw.acquire(timeout=DEADLINE)
        return draw_scene(observations)

    monkeypatch.setattr('al_questioner.ros.nodes.perception.draw_scene', draw_slowly)
    clouds = graph.listen('objects', PointCloud2)
    pictures = graph.listen('scene_image', Image)
    perception = graph.start(PerceptionNode, **graph.world)
    mouth = graph.ears.create_publisher(String, 'turn', qos.LATCHED)
    world = PerceivedWorld(WorldSpec(load_task(TASK), 4, 4).open())
    turns = world.change_turns(1000)[:3]
    for seen, turn in enumerate(turns, start=1):
        stamp = {'sec': turn, 'nanosec': 0}
        mouth.publish(String(data=write('turn', 'e', {'turn': turn, 'stamp': stamp, 'world': None})))
        graph.wait_for(lambda seen=seen: len(clouds) == seen, f'the objects of turn {turn}')
        graph.wait_for(lambda: drawn, 'the first picture')
    assert not pictures
    looked = threading.Event()
    perception.submit(looked.set)
    graph.wait_for(looked.is_set, 'the order for the last picture')
    for count in (1, 2):
        # One by one, as a latched topic holds no more than its last message for a listener that is behind.
        may_draw.release()
        graph.wait_for(lambda count=count: len(pictures) == count, f'picture {count}')
    assert [picture.header.stamp.sec for picture in pictures] == [turns[0], turns[2]]
    assert drawn == [[observation.object_id for observation in world.observations(turn)] for turn in turns[::2]]


def test_late_nodes_catch_up(graph: Any) -> None:
    """Otherwise the order in which nodes are started would matter."""
    states, queries, turns = map(graph.listen, ('learner_state', 'query', 'turn'))
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: turns, 'the first turn')
    graph.start(PerceptionNode, **graph.world)
    graph.wait_for(lambda: queries, 'the first query')
    graph.start(TeacherNode, **graph.world)
    graph.wait_for_end(states)


def test_two_robots_in_two_namespaces_do_not_hear_each_other(graph: Any) -> None:
    """Otherwise the answers to one robot would teach the other."""
    robots = {'left': (TASK, 4), 'right': ('pack_lunchbox', 5)}
    kinds = ('episode', 'turn', 'query', 'learner_state', 'answer', 'answer_ack')
    heard: dict[str, dict[str, list[Any]]] = {robot: {} for robot in robots}
    nodes = []
    for robot, (task, seed) in robots.items():
        namespace = f'{graph.namespace}/{robot}'
        for kind in kinds:
            profile = qos.RECORDED_EVENTS if kind.startswith('answer') else qos.RECORDED_LATCHED
            heard[robot][kind] = graph.listen(f'{robot} {kind}', profile=profile, topic=f'/{namespace}/{kind}')
        world = {'task': task, 'seed': seed}
        for make, parameters in ((PerceptionNode, world), (TeacherNode, world), (LearnerNode, graph.episode | world)):
            nodes.append(graph.start(make, namespace=namespace, **parameters))
    for robot, (task, seed) in robots.items():
        state = graph.wait_for_end(heard[robot]['learner_state'])
        assert state['queries'] == offline_queries('random_fsq', 6.0, 8, task=task, seed=seed)
    for robot in robots:
        said = [document for kind in kinds for document in heard[robot][kind]]
        assert len({document['episode_id'] for document in said}) == 1
    # Whatever a node had heard of the other robot's world or episode, it would have refused.
    assert not any(node.counts() for node in nodes)


def test_nothing_is_amiss_in_an_episode_among_ourselves(graph: Any, diagnostics: Any) -> None:
    """Otherwise a warning that means nothing would teach people to overlook those that do."""
    graph.play(turns=12, turn_period=0.2)

    def names() -> set[str]:
        return {status.name.rsplit('/', 1)[-1] for status in diagnostics.statuses}

    graph.wait_for(lambda: names() == {'perception', 'learner', 'teacher'}, 'the diagnostics of all')
    assert [status.message for status in diagnostics.statuses if status.level != DiagnosticStatus.OK] == []


def test_a_node_that_waits_in_vain_names_the_topic_and_who_publishes_there(
    graph: Any, diagnostics: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise nobody would know what is missing, or under which name."""
    monkeypatch.setattr('al_questioner.ros.node.SECONDS_FOR_PUBLISHER', 0.0)
    monkeypatch.setattr('al_questioner.protocol.learner.SECONDS_FOR_OBJECTS', 0.0)

    def says(node: Node, end: str) -> bool:
        name = node.get_fully_qualified_name().lstrip('/')
        found = [status for status in diagnostics.statuses if status.name == name]
        return bool(found) and found[-1].level == DiagnosticStatus.WARN and found[-1].message.endswith(end)

    topic = f'/{graph.namespace}/'
    teacher = graph.start(TeacherNode, **graph.world)
    end = f'waiting for a query for too long: nobody publishes {topic}query'
    graph.wait_for(lambda: says(teacher, end), 'the warning of a teacher without a learner')
    learner = graph.start(LearnerNode, **graph.episode)
    end = f'turn 1: waiting for objects for too long: nobody publishes {topic}objects'
    graph.wait_for(lambda: says(learner, end), 'the warning of a learner without eyes')
    graph.wait_for(lambda: not says(teacher, 'query'), 'the end of the warning')
    graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    end = f'turn 1: waiting for objects for too long: {topic}objects is published by {topic}ears'
    graph.wait_for(lambda: says(learner, end), 'the name of who publishes nothing of use')
