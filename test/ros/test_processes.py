"""Nodes as their users start and end them."""

from __future__ import annotations

import os
import signal
from typing import Any

import pytest

DEADLINE = 90.0


@pytest.mark.parametrize('interrupts', [pytest.param(1, marks=pytest.mark.slow), 2])
@pytest.mark.parametrize('name', ['perception', 'learner', 'teacher', 'recognise'])
def test_nodes_end_cleanly_when_interrupted(processes: Any, name: str, interrupts: int) -> None:
    """Otherwise Ctrl-C, which `ros2 launch` sends twice, would leave a traceback or a process behind."""
    process = processes.node(name, task='prepare_lunch')
    processes.wait_for_log(name, 'is up')
    for _ in range(interrupts):
        os.killpg(process.pid, signal.SIGINT)
    assert process.wait(DEADLINE) == 0, processes.log(name)
    assert 'Traceback' not in processes.log(name)


@pytest.mark.parametrize(
    ('name', 'parameter', 'reason'),
    [
        ('learner', 'budget:=', 'unusable ROS arguments'),
        ('learner', 'budget', 'unusable ROS arguments'),
        ('learner', 'bugdet:=3', 'unknown parameter bugdet'),
        ('learner', 'budget:=-1.0', 'budget must be 0 or more, not -1.0'),
        ('teacher', 'wrong_rate:=.nan', 'wrong_rate must be a finite number'),
        ('perception', 'task:=prepare_luch', 'unknown task'),
    ],
)
def test_unusable_parameters_end_with_status_2_and_one_line(
    name: str, parameter: str, reason: str, refusal: Any
) -> None:
    """Otherwise a mistyped parameter would end in a traceback, or be ignored."""
    assert reason in refusal(name, '--ros-args', '-p', parameter)


def test_the_status_of_a_process_is_that_of_its_executable(processes: Any) -> None:
    """Otherwise `ros2 launch` would take a node that never was for one that has done its work."""
    done = processes.run('learner', '--ros-args', '-p', 'strategy:=clever')
    assert (done.returncode, done.stderr.count('\n')) == (2, 1), done.stderr
    assert 'unknown strategy' in done.stderr
