"""The breakdown of a turn: its sums, and that it runs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from shared.checkout import ROOT

DEADLINE = 280
TOPICS = ('turn', 'objects', 'query', 'decision', 'scene_markers', 'answer', 'answer_ack', 'learner_state')


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))
    command = [sys.executable, str(ROOT / 'benchmarks' / 'turn.py'), *arguments]
    variables = {**os.environ, 'PYTHONPATH': path, **environment}
    return subprocess.run(command, env=variables, capture_output=True, text=True, timeout=DEADLINE, check=False)


def test_a_turn_is_the_sum_of_its_parts() -> None:
    """Otherwise transport would be blamed for work, or the other way round."""
    from turn_parts.accounts import remainders, transport_seconds

    # Writing takes 1 s and reading 10 s, whatever it is.
    encodings = {topic: SimpleNamespace(writing=np.array([1.0]), reading=np.array([10.0])) for topic in TOPICS}
    encoding, rest = remainders(np.array([100.0, 100.0]), np.array([30.0, 20.0]), [True, False], encodings)
    # Asked: turn, objects, query and answer there and read; acknowledgement and state away. Else: two, and two.
    assert encoding.tolist() == [4 * 11 + 2, 2 * 11 + 2]
    assert rest.tolist() == [100 - 30 - 46, 100 - 20 - 24]

    hops = {topic: SimpleNamespace(there=np.array([7.0, 7.0, 90.0]), publishing=np.array([3.0])) for topic in TOPICS}
    assert transport_seconds(hops, asked=True) == 4 * 7 + 2 * 3
    assert transport_seconds(hops, asked=False) == 2 * 7 + 2 * 3


@pytest.mark.slow
def test_offline_part_runs_and_adds_up(tmp_path: Path) -> None:
    """Otherwise nobody could measure on a machine without ROS."""
    path = tmp_path / 'turn.json'
    done = run('--turns', '3', '--repeats', '1', '--offline', '--json', str(path))
    assert done.returncode == 0, done.stderr
    assert 'choosing what to ask' in done.stdout
    offline = json.loads(path.read_text())['offline']
    parts = sum(stage['total_s'] for stage in offline['stages'].values()) + offline['making_s']
    assert parts == pytest.approx(offline['total_s'])


def test_missing_ros_is_told_in_one_line(tmp_path: Path) -> None:
    """Otherwise a traceback would not say that --offline does without."""
    (tmp_path / 'rclpy.py').write_text("raise ImportError('no ROS here')\n")
    done = run('--turns', '3', PYTHONPATH=os.pathsep.join((str(tmp_path), str(ROOT))))
    assert done.returncode == 2
    assert done.stderr.splitlines() == ['ROS 2 cannot be imported (no ROS here): use --offline']


@pytest.mark.parametrize(
    ('arguments', 'complaint'),
    [
        (['--repeats', '0'], '--repeats and --round-trips must be 1 or more'),
        (['--turns', '2'], '--turns must be 3 or more for the graph: its first and last turn are not timed'),
        (['--offline', '--strategy', 'none_such'], 'none_such'),
    ],
)
def test_unusable_arguments_are_refused(
    arguments: list[str], complaint: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise a quarter of an hour would be measured for nothing."""
    import turn

    monkeypatch.setattr(sys, 'argv', ['turn.py', *arguments])
    assert turn.main() == 2
    error = capsys.readouterr().err
    assert complaint in error
    assert len(error.splitlines()) == 1


@pytest.mark.slow
def test_the_graph_part_runs(tmp_path: Path) -> None:
    """Otherwise the tables of the graph would rot unseen, since nobody measures every day."""
    path = tmp_path / 'turn.json'
    done = run('--turns', '12', '--repeats', '1', '--round-trips', '5', '--json', str(path))
    assert done.returncode == 0, done.stdout + done.stderr
    assert 'queries as the offline episode, with the same answers' in done.stdout
    figures = json.loads(path.read_text())
    assert set(figures['encoding']) == set(figures['hops']) == {*TOPICS, 'scene_image'}
    parts = figures['graph']['parts']
    whole = parts.pop('a turn of the graph')['mean']
    parts.pop('transport by round trips')
    assert sum(part['mean'] for part in parts.values()) == pytest.approx(whole)
