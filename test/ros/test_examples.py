"""The examples that users copy."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import Any

EXAMPLES = Path(__file__).resolve().parents[2] / 'docs' / 'examples'
DEADLINE = 90.0


def test_a_robots_own_perception_teaches_the_learner(processes: Any) -> None:
    """The example that users copy for their own robot would not work."""
    remap = ['--ros-args', '-r', f'__ns:=/{processes.namespace}']
    processes.start('own_perception', [sys.executable, str(EXAMPLES / 'own_perception.py'), *remap])
    task = str(EXAMPLES / 'blobs.yaml')
    learner = processes.node('learner', task=task, strategy='random_fsq', view_tolerance=0.5)
    processes.start('person', [sys.executable, str(Path(__file__).with_name('person.py')), *remap])
    processes.wait_for_log('learner', 'the episode is over: 6 of 6 spent')
    os.killpg(learner.pid, signal.SIGINT)
    assert learner.wait(DEADLINE) == 0
