"""A replayed bag is the recorded episode again, on its topics, for whoever listens."""

from __future__ import annotations

import dataclasses
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.bags import BagMessage, BagWriter, Topic, deserialize, read_bag, read_episodes
from al_questioner.bags.playback import Playback
from al_questioner.domain import InputError
from al_questioner.messages import documents
from al_questioner.messages.clouds import scene_of_cloud
from al_questioner.ros import qos
from al_questioner.ros.message_classes import installed_part, message_class
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.replayer import ReplayNode, common_namespace
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.simulation import ScriptedTeacher, WorldSpec, episode_settings, load_task, run_episode
from shared.checkout import ROOT

BAG = ROOT / 'bags' / 'expert_0'
DEADLINE = 60.0


def replay(graph: Any, *, paused: bool = False, rate: float = 1.0, clock_hz: float = 0.0, **node: Any) -> ReplayNode:
    bag = read_bag(BAG)

    def make(**node_arguments: Any) -> ReplayNode:
        return ReplayNode(
            bag, Playback(bag.messages, rate, paused=paused), DEADLINE, clock_hz, **node, **node_arguments
        )

    return graph.start(make)


def test_everything_is_published_as_it_was_recorded(graph: Any) -> None:
    """A page or a second learner would see another demonstration."""
    heard = {
        'turn': graph.listen('turn', profile=qos.RECORDED_LATCHED),
        'objects': graph.listen('objects', PointCloud2, qos.RECORDED_LATCHED),
        'decision': graph.listen('decision', PointCloud2, qos.RECORDED_EVENTS),
    }
    node = replay(graph, paused=True)
    expected = Counter[str]()
    # One by one, as a latched topic holds no more than its last message for a listener that is behind.
    for message in read_bag(BAG).messages:
        expected[message.topic.rsplit('/', 1)[-1]] += 1
        node.press('s')
        graph.wait_for(
            lambda: all(len(found) == expected[name] for name, found in heard.items()), f'message {expected.total()}'
        )
    assert [document['turn'] for document in heard['turn']] == list(range(1, 31))
    for name in ('objects', 'decision'):
        for ours, message in zip(heard[name], _recorded(name), strict=True):
            theirs = deserialize(message)
            assert bytes(ours.data) == theirs.data.tobytes()
            assert _stamp(ours) == _stamp(theirs)
    graph.wait_for(lambda: node.over, 'the end of the replay')


def test_a_step_is_a_turn_of_the_learner(graph: Any) -> None:
    """A person could not look at one turn after the other."""
    turns = graph.listen('turn', profile=qos.RECORDED_LATCHED)
    node = replay(graph, paused=True)
    for turn, key in enumerate(('right', 'n', 'n'), start=1):
        node.press(key)
        graph.wait_for(lambda n=turn: [document['turn'] for document in turns] == list(range(1, n + 1)), f'turn {turn}')
    assert node.playback.turn == 3


def test_the_scenes_of_a_replay_are_the_recorded_ones(graph: Any) -> None:
    """A learner that listens would see other things, or in another order."""
    clouds = graph.listen('objects', PointCloud2, qos.RECORDED_LATCHED)
    node = replay(graph, rate=2.0)
    graph.wait_for(lambda: node.over, 'the end of the replay')
    graph.wait_for(lambda: clouds and _stamp(clouds[-1]) == _stamp(deserialize(_recorded('objects')[-1])), 'the last')
    (episode,) = read_episodes(BAG)
    shown = {turn.scene.features.tobytes(): turn.scene.object_ids for turn in episode.turns}
    assert [_stamp(cloud) for cloud in clouds] == sorted({_stamp(cloud) for cloud in clouds})
    for cloud in clouds:
        scene = scene_of_cloud(cloud)
        assert shown[scene.features.tobytes()] == scene.object_ids


def test_latched_topics_stay_for_late_listeners(graph: Any) -> None:
    """RViz, started after the replay, would stay empty."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    replay(graph, rate=5.0)
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the replay')
    late = graph.listen('late', topic='learner_state')
    graph.wait_for(lambda: late, 'the latched state')
    assert late[-1]['done']


def test_nothing_is_played_before_somebody_listens(graph: Any) -> None:
    """The first decisions would be lost to whoever was started together with the replay."""
    node = replay(graph)
    ticks = graph.listen('/diagnostics', DiagnosticArray, qos.DIAGNOSTICS)

    def waiting() -> int:
        ours = [tick.status[0] for tick in ticks if graph.namespace in tick.status[0].name]
        return [status.message for status in ours].count('waiting for listeners')

    graph.wait_for(lambda: waiting() >= 2, 'two signs of life')
    assert not node.begun
    decisions = graph.listen('decision', PointCloud2, qos.RECORDED_EVENTS)
    graph.wait_for(lambda: decisions, 'a decision')
    assert _stamp(decisions[0]) == _stamp(deserialize(_recorded('decision')[0]))


def test_a_key_begins_without_listeners(graph: Any) -> None:
    """A person would have to wait for listeners that are not to come."""
    node = replay(graph)
    node.press('s')
    graph.wait_for(lambda: node.playback.position == 1, 'the first message')
    assert node.playback.paused
    node.press('x')
    node.press('up')
    graph.wait_for(lambda: node.playback.rate == 1.25, 'the higher rate')
    assert node.playback.position == 1
    node.press(' ')
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert node.playback.position == len(read_bag(BAG).messages)


def test_a_replay_does_not_begin_on_the_names_of_a_live_learner(graph: Any) -> None:
    """A recorded turn could replace a live one before perception sees it, and the robot would wait for ever."""
    turns = graph.listen('turn', profile=qos.RECORDED_LATCHED)
    graph.start(LearnerNode, **graph.episode)
    node = replay(graph)
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert f'/{graph.namespace}/learner publishes on /{graph.namespace}/turn, too' in str(node.failure)
    node.press('n')
    graph.wait_for(lambda: turns, 'the turn of the live learner')
    assert not node.begun
    assert {document['episode_id'].rsplit('-', 1)[0] for document in turns} == {'prepare_lunch-4'}


def test_a_replay_ends_when_a_learner_takes_its_names(graph: Any) -> None:
    """A robot that is started beside a paused replay would be disturbed as soon as the replay goes on."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    node = replay(graph, paused=True)
    node.press('n')
    graph.wait_for(lambda: node.playback.turn == 1, 'the first turn')
    graph.start(TeacherNode, **graph.world)
    graph.start_robot()
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert '/learner publishes on' in str(node.failure)
    node.press(' ')
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the live episode')
    assert node.playback.turn == 1
    task, seed = load_task('prepare_lunch'), graph.world['seed']
    settings = episode_settings(task, graph.episode['strategy'], graph.episode['budget'], graph.episode['turns'])
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, seed)
    offline = run_episode(WorldSpec(task, seed, seed), settings, teacher)
    assert states[-1]['queries'] == [documents.record_members(record) for record in offline.queries]


def test_the_recorded_time_is_told(graph: Any) -> None:
    """use_sim_time would stand still."""
    clocks = graph.listen('/clock', Clock, 10)
    node = replay(graph, clock_hz=50.0)
    node.press(' ')
    node.press(' ')
    end = read_bag(BAG).messages[-1].stamp
    graph.wait_for(lambda: any(_nanoseconds(c.clock) == end for c in clocks), 'the last stamp')
    stamps = [_nanoseconds(c.clock) for c in clocks]
    assert stamps == sorted(stamps)
    assert stamps[0] >= read_bag(BAG).messages[0].stamp


def test_the_last_stamp_is_told_however_rarely_the_time_is(graph: Any) -> None:
    """Whoever waits for the end by the recorded time would wait for ever."""
    clocks = graph.listen('/clock', Clock, 10)
    node = replay(graph, clock_hz=0.001)
    node.press(' ')
    node.press(' ')
    graph.wait_for(lambda: node.over and clocks, 'the end of the replay')
    assert [_nanoseconds(c.clock) for c in clocks] == [read_bag(BAG).messages[-1].stamp]


def test_a_replay_is_not_over_before_its_last_messages_have_arrived(
    graph: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They would be lost with the process that published them."""
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
    """Two replays, or a replay beside the robot, could not be kept apart."""
    text = 'std_msgs/msg/String'
    names = ('/fleet/a/turn', '/fleet/b/turn', '/diagnostics', '/clock')
    types = (text, text, 'diagnostic_msgs/msg/DiagnosticArray', 'rosgraph_msgs/msg/Clock')
    topics = [Topic(name, type_, False) for name, type_ in zip(names, types, strict=True)]
    with BagWriter(tmp_path / 'b', topics) as writer:
        writer.write('/fleet/a/turn', b'\x00\x01\x00\x00\x01\x00\x00\x00\x00', 1)
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
    """Two namespaces in one bag would be mixed, or one would not follow a new namespace."""
    assert common_namespace(topics) == namespace


def test_a_message_type_that_is_not_installed_is_named() -> None:
    """The replay would end with a traceback."""
    with pytest.raises(InputError, match='message type robot_msgs/msg/Pose of the bag is not installed'):
        message_class('robot_msgs/msg/Pose')
    with pytest.raises(InputError, match='message type std_msgs/msg/Nothing of the bag is not installed'):
        message_class('std_msgs/msg/Nothing')


def test_what_is_not_installed_is_passed_over() -> None:
    """A recording of the whole robot could not be played, for one topic of a type that nobody listens to."""
    bag = read_bag(BAG)
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
    """A bag of the whole robot could not be played beside one that speaks."""
    text = 'std_msgs/msg/String'
    chat = Topic('/chat/turn', text, False)
    ours = next(message for message in read_bag(BAG).messages if message.topic.endswith('/turn'))
    with BagWriter(tmp_path / 'b', [Topic('/robot/turn', text, True), chat]) as writer:
        writer.write('/robot/turn', ours.data, 1)
        writer.write('/chat/turn', b'\x00\x01\x00\x00\x01\x00\x00\x00\x00', 2)
    bag = read_bag(tmp_path / 'b')
    graph.ears.create_publisher(String, 'chat/turn', qos.LATCHED)
    node = graph.start(lambda **others: ReplayNode(bag, Playback(bag.messages, paused=True), 0.0, 0.0, **others))
    graph.wait_for(lambda: node.other_publishers(f'/{graph.namespace}/chat/turn'), 'the other publisher')
    node.press(' ')
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert node.failure is None
    assert node.playback.position == 2


def _recorded(name: str) -> list[BagMessage]:
    return [message for message in read_bag(BAG).messages if message.topic.endswith(f'/{name}')]


def _stamp(cloud: Any) -> int:
    return _nanoseconds(cloud.header.stamp)


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)
