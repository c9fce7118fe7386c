"""A replayed bag is the recorded episode again, on its topics, for all who listen."""

from __future__ import annotations

import dataclasses
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.bags import BagMessage, BagWriter, Topic, deserialize, read_bag
from al_questioner.bags.playback import Playback
from al_questioner.domain import InputError
from al_questioner.messages.stamps import nanoseconds
from al_questioner.ros import qos
from al_questioner.ros.message_classes import installed_part, message_class
from al_questioner.ros.nodes.replayer import ReplayNode, common_namespace
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.bags import SHIPPED, STRING, recorded, text
from shared.offline import offline_queries

DEADLINE = 60.0


def stamp_in(cloud: Any) -> int:
    return nanoseconds(cloud.header.stamp)


def replay(graph: Any, *, paused: bool = False, rate: float = 1.0, clock_hz: float = 0.0, **node: Any) -> ReplayNode:
    bag = read_bag(SHIPPED)

    def make(**node_arguments: Any) -> ReplayNode:
        return ReplayNode(
            bag, Playback(bag.messages, rate, paused=paused), DEADLINE, clock_hz, **node, **node_arguments
        )

    return graph.start(make)


def test_everything_is_published_as_it_was_recorded(graph: Any) -> None:
    """Otherwise a page or a second learner would see another demonstration."""
    heard = {
        'turn': graph.listen('turn', profile=qos.RECORDED_LATCHED),
        'objects': graph.listen('objects', PointCloud2, qos.RECORDED_LATCHED),
        'decision': graph.listen('decision', PointCloud2, qos.RECORDED_EVENTS),
    }
    node = replay(graph, paused=True)
    expected = Counter[str]()
    # One by one, as a latched topic holds no more than its last message for a listener that is behind.
    for message in read_bag(SHIPPED).messages:
        expected[message.topic.rsplit('/', 1)[-1]] += 1
        node.press('s')
        graph.wait_for(
            lambda: all(len(found) == expected[name] for name, found in heard.items()), f'message {expected.total()}'
        )
    assert [document['turn'] for document in heard['turn']] == list(range(1, 31))
    for name in ('objects', 'decision'):
        for ours, message in zip(heard[name], recorded(name), strict=True):
            theirs = deserialize(message)
            assert bytes(ours.data) == theirs.data.tobytes()
            assert stamp_in(ours) == stamp_in(theirs)
    graph.wait_for(lambda: node.over, 'the end of the replay')


def test_latched_topics_stay_for_late_listeners(graph: Any) -> None:
    """Otherwise RViz, started after the replay, would stay empty."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    node = replay(graph, rate=1000.0)
    node.press('up')
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the replay')
    late = graph.listen('late', topic='learner_state')
    graph.wait_for(lambda: late, 'the latched state')
    assert late[-1]['done']


def test_a_replay_begins_by_itself_once_somebody_listens(graph: Any) -> None:
    """A subscriber that is started together with the replay gets the first decisions."""
    replay(graph, rate=1000.0)
    decisions = graph.listen('decision', PointCloud2, qos.RECORDED_EVENTS)
    graph.wait_for(lambda: decisions, 'a decision')
    assert stamp_in(decisions[0]) == stamp_in(deserialize(recorded('decision')[0]))


def test_a_replay_ends_when_a_learner_takes_its_names(graph: Any) -> None:
    """Otherwise a robot that is started beside a paused replay would be disturbed as soon as the replay goes on."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    node = replay(graph, paused=True)
    node.press('n')
    graph.wait_for(lambda: node.playback.turn == 1, 'the first turn')
    graph.start(TeacherNode, **graph.world)
    graph.start_robot()
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert '/learner publishes on' in str(node.failure)
    node.press(' ')
    queries = graph.wait_for_end(states)['queries']
    assert node.playback.turn == 1
    assert queries == offline_queries('random_fsq', 6.0, 8)


def test_the_recorded_time_is_told(graph: Any) -> None:
    """Otherwise use_sim_time would stand still."""
    clocks = graph.listen('/clock', Clock, 10)
    node = replay(graph, rate=10.0, clock_hz=50.0)
    graph.wait_for(lambda: clocks, 'the time before the beginning')
    node.press('up')
    begin, *_, end = (message.stamp for message in read_bag(SHIPPED).messages)
    graph.wait_for(lambda: any(nanoseconds(c.clock) == end for c in clocks), 'the last stamp')
    graph.wait_for(lambda: node.over, 'the end of the replay')
    stamps = [nanoseconds(c.clock) for c in clocks]
    assert stamps == sorted(stamps)
    assert stamps[0] == begin
    assert len(set(stamps)) > 3


def test_a_replay_is_not_over_before_its_last_messages_have_arrived(
    graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Otherwise they would be lost with the process that published them."""
    nodes: list[ReplayNode] = []
    waited: list[tuple[str, bool]] = []

    def wait(publisher: Publisher, timeout: Any) -> bool:
        waited.append((publisher.topic_name, nodes[0].over))
        return True

    monkeypatch.setattr(Publisher, 'wait_for_all_acked', wait)
    nodes.append(replay(graph, paused=True, rate=1000.0))
    nodes[0].press(' ')
    graph.wait_for(lambda: nodes[0].over, 'the end of the replay')
    assert sorted(waited) == sorted((topic, False) for topic in (out.topic_name for out in nodes[0]._out.values()))


def test_names_follow_the_namespace_that_is_given(graph: Any, tmp_path: Path) -> None:
    """Otherwise two replays, or a replay beside the robot, could not be kept apart."""
    names = ('/fleet/a/turn', '/fleet/b/turn', '/diagnostics', '/clock')
    types = (STRING, STRING, 'diagnostic_msgs/msg/DiagnosticArray', 'rosgraph_msgs/msg/Clock')
    topics = [Topic(name, type_, False) for name, type_ in zip(names, types, strict=True)]
    with BagWriter(tmp_path / 'b', topics) as writer:
        writer.write('/fleet/a/turn', text(''), 1)
        writer.write('/clock', b'\x00\x01\x00\x00' + bytes(8), 2)
    bag = read_bag(tmp_path / 'b')

    def published(clock_hz: float = 0.0, **node_arguments: Any) -> set[str]:
        def make(**others: Any) -> ReplayNode:
            given = {**others, **node_arguments}
            given.pop('namespace') if given['namespace'] is None else None
            return ReplayNode(bag, Playback(bag.messages, paused=True), 0.0, clock_hz, **given)

        node = graph.start(make)
        found = {out.topic_name for out in node._out.values()}
        graph.stop(node)
        return found

    assert published(namespace=None) == set(names)
    assert published(namespace='x') == {'/x/a/turn', '/x/b/turn', '/diagnostics', '/clock'}
    remapped = ['--ros-args', '-r', '__ns:=/y', '-r', 'a/turn:=/z/turn']
    assert published(namespace=None, cli_args=remapped) == {'/z/turn', '/y/b/turn', '/diagnostics', '/clock'}
    assert published(namespace=None, clock_hz=1.0) == set(names) - {'/clock'}


@pytest.mark.parametrize(
    ('topics', 'namespace'),
    [
        (['/a/turn', '/a/objects'], '/a'),
        (['/a/turn', '/a/camera/image', '/diagnostics', '/rosout'], '/a'),
        (['/fleet/a/turn', '/fleet/b/turn'], '/fleet'),
        (['/ab/turn', '/ac/turn'], ''),
        (['/turn', '/a/turn'], ''),
        (['/turn'], ''),
        (['/diagnostics'], ''),
    ],
)
def test_the_common_namespace(topics: list[str], namespace: str) -> None:
    """Otherwise two namespaces in one bag would be mixed, or one would not follow a new namespace."""
    assert common_namespace(topics) == namespace


@pytest.mark.parametrize('name', ['robot_msgs/msg/Pose', 'std_msgs/msg/Nothing'])
def test_a_message_type_that_is_not_installed_is_named(name: str) -> None:
    """Otherwise the replay would end with a traceback."""
    with pytest.raises(InputError, match=f'message type {name} of the bag is not installed'):
        message_class(name)


def test_what_is_not_installed_is_passed_over() -> None:
    """Otherwise a recording of the whole robot could not be played, for one topic of a type that nobody listens to."""
    bag = read_bag(SHIPPED)
    others = (Topic('/events/write_split', 'rosbag2_interfaces/msg/WriteSplitEvent', False), Topic('/a', '', False))
    foreign = [BagMessage(topic.name, topic.type, bag.messages[0].stamp, b'') for topic in others]
    part, missing = installed_part(
        dataclasses.replace(bag, topics=(*others, *bag.topics), messages=(*foreign, *bag.messages))
    )
    assert part == bag
    assert missing == {topic.type: [topic.name] for topic in others}
    with pytest.raises(InputError, match='nothing can be played: rosbag2_interfaces/msg/WriteSplitEvent'):
        installed_part(dataclasses.replace(bag, topics=others, messages=tuple(foreign)))


def test_a_replay_yields_to_no_other_topic_of_that_name(graph: Any, tmp_path: Path) -> None:
    """Otherwise a bag of the whole robot could not be played beside one that speaks."""
    with BagWriter(tmp_path / 'b', [Topic('/robot/turn', STRING, True), Topic('/chat/turn', STRING, False)]) as writer:
        writer.write('/robot/turn', recorded('turn')[0].data, 1)
        writer.write('/chat/turn', text(''), 2)
    bag = read_bag(tmp_path / 'b')
    graph.ears.create_publisher(String, 'chat/turn', qos.LATCHED)
    node = graph.start(lambda **others: ReplayNode(bag, Playback(bag.messages, paused=True), 0.0, 0.0, **others))
    graph.wait_for(lambda: node.other_publishers(f'/{graph.namespace}/chat/turn'), 'the other publisher')
    node.press(' ')
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert node.failure is None
    assert node.playback.position == 2
