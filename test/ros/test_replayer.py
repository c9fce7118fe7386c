"""A replayed bag is the recorded episode again, on its topics, for whoever listens."""

from __future__ import annotations

import os
import pty
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2

from al_questioner.cli import main
from al_questioner.recording import deserialize, read_bag, read_sessions
from al_questioner.recording.playback import Playback
from al_questioner.ros import qos
from al_questioner.ros.learner import LearnerNode
from al_questioner.ros.replayer import ReplayNode, common_namespace

BAG = Path(__file__).resolve().parents[2] / 'bags' / 'expert_0'
DEADLINE = 60.0


def replay(graph: Any, rate: float = 1.0, clock_hz: float = 0.0, delay: float = 1.0, **parameters: Any) -> ReplayNode:
    bag = read_bag(BAG)

    def make(**node_arguments: Any) -> ReplayNode:
        return ReplayNode(bag, Playback(bag.messages, rate), delay, clock_hz, **node_arguments)

    return graph.start(make, **parameters)


def test_everything_is_published_as_it_was_recorded(graph: Any) -> None:
    """A page or a second learner would see another demonstration."""
    turns = graph.listen('turn', profile=qos.RECORDED_LATCHED)
    clouds = graph.listen('objects', PointCloud2, qos.RECORDED_LATCHED)
    decisions = graph.listen('decision', PointCloud2, qos.RECORDED_EVENTS)
    replay(graph)
    graph.wait_for(lambda: len(turns) == len(clouds) == len(decisions) == 30, 'thirty turns')
    assert [document['turn'] for document in turns] == list(range(1, 31))
    recorded = [deserialize(m) for m in read_bag(BAG).messages if m.topic.endswith('/objects')]
    for heard, expected in zip(clouds, recorded, strict=True):
        assert bytes(heard.data) == expected.data.tobytes()
        assert heard.header.stamp.nanosec == expected.header.stamp.nanosec


def test_latched_topics_stay_for_late_listeners(graph: Any) -> None:
    """RViz, started after the replay, would stay empty."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    replay(graph, rate=5.0)
    graph.wait_for(lambda: states and states[-1]['done'], 'the end of the replay')
    late = graph.listen('late', topic='learner_state')
    graph.wait_for(lambda: late, 'the latched state')
    assert late[-1]['done']


def test_a_second_learner_sees_the_recorded_scenes(graph: Any) -> None:
    """By the recorded time on /clock: it could otherwise not take scenes that are older than its turn."""
    states = graph.listen('learner_state', topic=f'/{graph.namespace}_2/learner_state', profile=qos.RECORDED_LATCHED)
    remapped = ['--ros-args', '-r', f'objects:=/{graph.namespace}/objects']

    def make(**node_arguments: Any) -> LearnerNode:
        return LearnerNode(**node_arguments, cli_args=remapped)

    learner = graph.start(
        make,
        namespace=f'{graph.namespace}_2',
        task='prepare_lunch',
        strategy='u_sampling',
        budget=0.0,
        turns=8,
        use_sim_time=True,
    )
    replay(graph, rate=0.2, clock_hz=200.0)
    graph.wait_for(lambda: states and states[-1]['turn'] >= 4, 'four turns of the second learner')
    (session,) = read_sessions(BAG)
    shown = {str(object_id) for turn in session.turns for object_id in turn.scene.object_ids}
    assert set(states[-1]['beliefs']) <= shown
    scene = learner._scene
    assert any(scene.features.tobytes() == turn.scene.features.tobytes() for turn in session.turns)


def test_the_recorded_time_is_told(graph: Any) -> None:
    """use_sim_time would stand still."""
    clocks = graph.listen('/clock', Clock, 10)
    replay(graph, clock_hz=50.0, delay=0.0)
    end = read_bag(BAG).messages[-1].stamp
    graph.wait_for(lambda: any(c.clock.sec * 10**9 + c.clock.nanosec >= end for c in clocks), 'the last stamp')
    stamps = [c.clock.sec * 10**9 + c.clock.nanosec for c in clocks]
    assert stamps == sorted(stamps)


def test_the_common_namespace() -> None:
    """Two namespaces in one bag must stay apart."""
    assert common_namespace(['/a/turn', '/a/objects']) == '/a'
    assert common_namespace(['/a/turn', '/b/turn']) == ''
    assert common_namespace(['/turn']) == ''


def test_checking_tells_of_the_first_divergence(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A change of the questioner would go unnoticed."""
    assert main(['replay', str(BAG), '--check']) == 0
    assert '30 decisions, all as recorded' in capsys.readouterr().out.replace('\n', ' ')


def test_unusable_arguments_end_with_status_2_and_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A typing error would play nothing, or for ever."""
    for arguments, reason in (
        ([str(tmp_path)], 'is no bag'),
        ([str(BAG), '--rate', '0'], 'rate must be a number above 0'),
        ([str(BAG), '--rate', 'nan'], 'rate must be a number above 0'),
        ([str(BAG), '--clock', '-1'], 'must be at least 0'),
        ([], 'required: BAG'),
    ):
        assert main(['replay', *arguments]) == 2
        error = capsys.readouterr().err
        assert reason in error
        assert error.count('\n') == 1


def test_keys_pause_step_and_quit(tmp_path: Path) -> None:
    """At a terminal: a paused replay plays turn by turn, and leaves the terminal as it was."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, 'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'COLUMNS': '100', 'TERM': 'xterm'}
    command = [sys.executable, '-m', 'al_questioner', 'replay', str(BAG), '--paused', '--delay', '0']
    command += ['--ros-args', '-r', f'__ns:=/keys_{os.getpid()}']
    process = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, env=environment)
    os.close(theirs)
    seen = b''
    try:
        seen = _read_until(ours, seen, b'paused')
        os.write(ours, b'n')
        seen = _read_until(ours, seen, b'turn 1 ')
        os.write(ours, b'\x1b[C')
        seen = _read_until(ours, seen, b'turn 2 ')
        os.write(ours, b'q')
        assert process.wait(DEADLINE) == 0
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        os.close(ours)


def _read_until(terminal: int, seen: bytes, wanted: bytes) -> bytes:
    end = time.monotonic() + DEADLINE
    while wanted not in seen:
        assert time.monotonic() < end, seen.decode(errors='replace')
        seen += os.read(terminal, 4096)
    return b''
