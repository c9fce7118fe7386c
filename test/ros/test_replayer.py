"""A replayed bag is the recorded episode again, on its topics, for whoever listens."""

from __future__ import annotations

import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray
from rcl_interfaces.msg import Log
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.cli import main
from al_questioner.domain import InputError
from al_questioner.messages import documents
from al_questioner.messages.clouds import scene_of_cloud
from al_questioner.recording import BagMessage, BagWriter, Topic, deserialize, read_bag, read_sessions
from al_questioner.recording.playback import Playback
from al_questioner.recording.scenes import scenes_of
from al_questioner.ros import qos
from al_questioner.ros.learner import LearnerNode
from al_questioner.ros.perception import PerceptionNode
from al_questioner.ros.replayer import ReplayNode, common_namespace, message_class
from al_questioner.ros.stand_in import StandInNode
from al_questioner.ros.teacher import TeacherNode
from al_questioner.simulation import WorldChoice, episode_settings, run_episode
from al_questioner.teaching import ScriptedTeacher
from al_questioner.world import load_task

BAG = Path(__file__).resolve().parents[2] / 'bags' / 'expert_0'
DEADLINE = 60.0


def replay(graph: Any, *, paused: bool = False, rate: float = 1.0, clock_hz: float = 0.0, **node: Any) -> ReplayNode:
    bag = read_bag(BAG)

    def make(**node_arguments: Any) -> ReplayNode:
        return ReplayNode(
            bag, Playback(bag.messages, rate, paused=paused), DEADLINE, clock_hz, **node, **node_arguments
        )

    return graph.start(make)


def stand_in(graph: Any) -> StandInNode:
    return graph.start(lambda **node_arguments: StandInNode(scenes_of(read_bag(BAG)), **node_arguments))


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
    node = replay(graph, rate=0.5)
    graph.wait_for(lambda: node.over, 'the end of the replay')
    graph.wait_for(lambda: clouds and _stamp(clouds[-1]) == _stamp(deserialize(_recorded('objects')[-1])), 'the last')
    (session,) = read_sessions(BAG)
    shown = {turn.scene.features.tobytes(): turn.scene.object_ids for turn in session.turns}
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
    assert node.playback.position == 163


def test_a_second_learner_asks_what_it_would_have_asked_in_the_recorded_world(graph: Any) -> None:
    """It would miss scenes, or the teacher would answer about other things."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    world = {'task': 'prepare_lunch', 'seed': 0}
    stand_in(graph)
    graph.start(TeacherNode, **world)
    graph.start(LearnerNode, **world, strategy='farthest_fsq', budget=12.0, turns=20)
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the second episode')
    task = load_task('prepare_lunch')
    settings = episode_settings(task, 'farthest_fsq', 12.0, 20)
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, 0)
    offline = run_episode(WorldChoice(task, 0, 0), settings, teacher)
    assert states[-1]['queries'] == [documents.record_members(record) for record in offline.queries]
    assert states[-1]['spent'] > 0


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
    offline = run_episode(WorldChoice(task, seed, seed), settings, teacher)
    assert states[-1]['queries'] == [documents.record_members(record) for record in offline.queries]


def test_two_perceptions_are_one_too_many(graph: Any) -> None:
    """A learner would see the recorded scene in one turn and another one in the next."""
    node = stand_in(graph)
    graph.start(PerceptionNode, **graph.world)
    graph.start(LearnerNode, **graph.episode)
    graph.wait_for(lambda: node.over, 'the end of the replay')
    assert f'/{graph.namespace}/perception shows objects, too' in str(node.failure)


def test_a_replay_that_must_not_go_on_ends_with_status_2(graph: Any) -> None:
    """A script would take an empty replay for a good one."""
    graph.start(LearnerNode, **graph.episode)
    command = [
        sys.executable,
        '-m',
        'al_questioner',
        'replay',
        str(BAG),
        '--ros-args',
        '-r',
        f'__ns:=/{graph.namespace}',
    ]
    environment = {**os.environ, 'ROS_DOMAIN_ID': str(graph.context.get_domain_id())}
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=environment, timeout=2 * DEADLINE)
    assert done.returncode == 2
    (line,) = done.stderr.decode().splitlines()
    assert line.startswith('replay: ')
    assert f'publishes on /{graph.namespace}/turn, too; keep the replay apart' in line
    assert 'UNKNOWN' not in line


def test_other_turns_than_the_recorded_ones_are_refused_with_their_number(graph: Any) -> None:
    """A learner with more turns than the bag would wait without a word."""
    node = stand_in(graph)
    clouds = graph.listen('objects', PointCloud2)
    turns = node.create_publisher(String, 'turn', qos.LATCHED)
    members = {'stamp': {'sec': 2_000_000_000, 'nanosec': 7}, 'world': None}
    turns.publish(String(data=documents.write('turn', 'e', {'turn': 31, **members})))
    graph.wait_for(lambda: node.counts().get('refused on turn') == 1, 'a refusal')
    assert not clouds
    turns.publish(String(data=documents.write('turn', 'e', {'turn': 30, **members})))
    graph.wait_for(lambda: clouds, 'the last recorded scene')
    recorded = _recorded('objects')[-1]
    assert bytes(clouds[0].data) == deserialize(recorded).data.tobytes()
    assert clouds[0].header.frame_id == deserialize(recorded).header.frame_id
    assert _stamp(clouds[0]) == 2_000_000_000 * 10**9 + 7


def test_a_learner_of_another_world_is_warned_of_and_shown_the_scenes(graph: Any) -> None:
    """The scripted teacher would answer about things that are not there, and nobody would know why."""
    warnings = graph.listen('/rosout', Log, 100)
    node = stand_in(graph)
    clouds = graph.listen('objects', PointCloud2)
    turns = node.create_publisher(String, 'turn', qos.LATCHED)
    world = {'task': 'prepare_lunch', 'seed': 9, 'sample': 0, 'dataset': None}
    for turn in (1, 2):
        stamp = {'sec': turn, 'nanosec': 0}
        turns.publish(String(data=documents.write('turn', 'e', {'turn': turn, 'stamp': stamp, 'world': world})))
        graph.wait_for(lambda n=turn: node.turn == n, f'turn {turn}')
    graph.wait_for(lambda: clouds and clouds[-1].header.stamp.sec == 2, 'the second scene')

    def about_worlds() -> list[str]:
        return [w.msg for w in warnings if 'seed 9, recorded 0' in w.msg and graph.namespace in w.name]

    graph.wait_for(about_worlds, 'a warning')
    assert len(about_worlds()) == 1


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


def test_checking_tells_of_the_first_divergence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A change of the questioner would go unnoticed."""
    assert main(['replay', str(BAG), '--check']) == 0
    assert '30 decisions, all as recorded' in capsys.readouterr().out.replace('\n', ' ')


def test_unusable_arguments_end_with_status_2_and_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A typing error would play nothing, or for ever."""
    with BagWriter(tmp_path / 'foreign', [Topic('/a', 'stereo_msgs/msg/DisparityImage', False)]) as foreign:
        foreign.write('/a', bytes(8), 1)
    for arguments, reason in (
        ([str(tmp_path)], 'is no bag'),
        ([str(tmp_path / 'none')], 'none: there is no such bag'),
        ([str(BAG), '--rate', '0'], 'rate must be a number above 0'),
        ([str(BAG), '--rate', '-1'], 'rate must be a number above 0'),
        ([str(BAG), '--rate', 'nan'], 'rate must be a number above 0'),
        ([str(BAG), '--rate', 'inf'], 'rate must be a number above 0'),
        ([str(BAG), '--rate', 'fast'], 'invalid float value'),
        ([str(BAG), '--clock', '-1'], 'must be at least 0'),
        ([str(BAG), '--clock', 'nan'], 'must be at least 0'),
        ([str(BAG), '--wait-for-subscribers', 'nan'], 'must be at least 0'),
        (
            [str(BAG), '--as-perception', '--start-paused'],
            '--start-paused has no meaning together with --as-perception',
        ),
        ([str(BAG), '--check', '--as-perception'], '--as-perception has no meaning together with --check'),
        ([str(tmp_path / 'foreign'), '--as-perception'], 'no turn with its objects'),
        ([str(BAG), '--ros-args', '-r', '__ns:=/a b'], 'unusable ROS arguments'),
        ([], 'required: BAG'),
    ):
        assert main(['replay', *arguments]) == 2, arguments
        error = capsys.readouterr().err
        assert reason in error
        assert error.count('\n') == 1, error


def test_a_message_type_that_is_not_installed_is_named() -> None:
    """The replay would end with a traceback."""
    with pytest.raises(InputError, match='message type robot_msgs/msg/Pose of the bag is not installed'):
        message_class('robot_msgs/msg/Pose')
    with pytest.raises(InputError, match='message type std_msgs/msg/Nothing of the bag is not installed'):
        message_class('std_msgs/msg/Nothing')


@contextmanager
def terminal_replay(*arguments: str) -> Iterator[tuple[subprocess.Popen[bytes], int, int]]:
    """A replay at a terminal: its process, our end of the terminal, and its own."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'COLUMNS': '120', 'TERM': 'xterm'}
    command = [sys.executable, '-m', 'al_questioner', 'replay', str(BAG), *arguments]
    command += ['--ros-args', '-r', f'__ns:=/keys_{os.getpid()}']
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment)
    try:
        yield process, ours, theirs
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(theirs)
        os.close(ours)


def test_keys_pause_step_and_quit() -> None:
    """At a terminal: a paused replay would not play turn by turn, or leave the terminal another than it was."""
    with terminal_replay('--start-paused', '--wait-for-subscribers', '0') as (process, ours, theirs):
        before = termios.tcgetattr(theirs)
        _read_until(ours, b'paused')
        os.write(ours, b'n')
        _read_until(ours, b'turn 1 ')
        os.write(ours, b'\x1b[C')
        _read_until(ours, b'turn 2 of 30')
        os.write(ours, b'\x1b[A\x1b[A')
        _read_until(ours, b'rate 1.56')
        assert termios.tcgetattr(theirs) != before
        os.write(ours, b'q')
        _read_until(ours, b'2 of 30 turns')
        assert process.wait(DEADLINE) == 0
        assert termios.tcgetattr(theirs) == before


@pytest.mark.parametrize('number', [signal.SIGINT, signal.SIGTERM])
def test_a_signal_leaves_the_terminal_as_it_was(number: signal.Signals) -> None:
    """A shell would stay without echo after Ctrl-C."""
    with terminal_replay('--start-paused') as (process, ours, theirs):
        before = termios.tcgetattr(theirs)
        _read_until(ours, b'paused')
        process.send_signal(number)
        _read_until(ours, b'nothing was played')
        assert process.wait(DEADLINE) == 0
        assert termios.tcgetattr(theirs) == before


def test_the_end_of_a_bag_arrives_and_a_closed_stdin_is_not_read(graph: Any) -> None:
    """The last state would be lost with the process that published it, and `replay` could not be launched."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    command = [sys.executable, '-m', 'al_questioner', 'replay', str(BAG), '--rate', '1e300']
    command += ['--wait-for-subscribers', str(DEADLINE), '--ros-args', '-r', f'__ns:=/{graph.namespace}']
    environment = {**os.environ, 'ROS_DOMAIN_ID': str(graph.context.get_domain_id())}
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, env=environment, timeout=2 * DEADLINE)
    assert done.returncode == 0, done.stderr.decode()
    assert done.stdout.decode().splitlines() == [
        f'{BAG}: 163 messages, 1.1 s',
        '163 of 163 messages played, 30 of 30 turns',
    ]
    graph.wait_for(lambda: states and states[-1]['done'], 'the last state')


def _read_until(terminal: int, wanted: bytes) -> None:
    """Read what a terminal shows up to some text, which is all on one line."""
    seen, end = b'', time.monotonic() + DEADLINE
    while wanted not in seen:
        assert time.monotonic() < end, seen.decode(errors='replace')
        if select.select([terminal], [], [], 0.1)[0]:
            seen += os.read(terminal, 4096)


def _recorded(name: str) -> list[BagMessage]:
    return [message for message in read_bag(BAG).messages if message.topic.endswith(f'/{name}')]


def _stamp(cloud: Any) -> int:
    return _nanoseconds(cloud.header.stamp)


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)
