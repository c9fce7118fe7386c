"""The `replay` executable beside other nodes."""

from __future__ import annotations

import subprocess
import sys
from typing import Any

import pytest

from al_questioner.bags import read_bag
from al_questioner.cli import main
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from shared.bags import SHIPPED as BAG

DEADLINE = 60.0


def test_a_replay_that_must_not_go_on_ends_with_status_2(graph: Any, capsys: pytest.CaptureFixture[str]) -> None:
    """Otherwise a script would take an empty replay for a good one."""
    graph.start(LearnerNode, **graph.episode)
    assert main(['replay', str(BAG), '--ros-args', '-r', f'__ns:=/{graph.namespace}']) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith('replay: ')
    assert f'publishes on /{graph.namespace}/turn, too; keep the replay apart' in line
    assert 'UNKNOWN' not in line


def test_the_end_of_a_bag_arrives_and_a_closed_stdin_is_not_read(graph: Any) -> None:
    """Otherwise the last state would be lost with the process that published it, and `replay` could not be launched."""
    states = graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    command = [sys.executable, '-m', 'al_questioner', 'replay', str(BAG), '--rate', '1e300']
    command += ['--wait-for-subscribers', str(DEADLINE), '--ros-args', '-r', f'__ns:=/{graph.namespace}']
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=2 * DEADLINE)
    assert done.returncode == 0, done.stderr.decode()
    messages = read_bag(BAG).messages
    seconds = (messages[-1].stamp - messages[0].stamp) / 1e9
    assert done.stdout.decode().splitlines() == [
        f'{BAG}: {len(messages)} messages, {seconds:.1f} s',
        f'{len(messages)} of {len(messages)} messages played, 30 of 30 turns',
    ]
    graph.wait_for(lambda: states and states[-1]['done'], 'the last state')
