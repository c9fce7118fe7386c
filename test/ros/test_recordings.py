"""Recordings that end, are ended or are killed, and what is learnt from them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from al_questioner.bags import read_bag
from al_questioner.cli import main
from al_questioner.imitation.bags import read_demonstrations
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.recorder import RecorderNode
from shared.bags import wait_for_content
from shared.checkout import ROOT

DEADLINE = 90.0
WORLD = {'task': 'prepare_lunch', 'seed': 4, 'wait_for_recorder': True}


def record(processes: Any, bag: Path, **parameters: object) -> subprocess.Popen[bytes]:
    """A recorder that is ready."""
    recorder = processes.node('record', bag=str(bag), **parameters)
    processes.wait_for_log('record', 'recording to')
    return recorder


@pytest.mark.slow
def test_a_person_shows_how_to_ask(processes: Any, tmp_path: Path) -> None:
    """Otherwise a person's way of asking could not be recorded, or not be learnt from."""
    bag, typed, out = tmp_path / 'bag', tmp_path / 'typed', tmp_path / 'w.yaml'
    typed.write_text('f\n3\nbeverage\n\nno such question\n5\n')
    recorder = record(processes, bag, until_done=True)
    for name in ('perception', 'teacher'):
        processes.node(name, **WORLD)
    processes.node('learner', typed, **WORLD, strategy='human', budget=9.0, turns=5)
    assert recorder.wait(DEADLINE) == 0, processes.log('record')
    assert 'is no question' in processes.log('learner')
    (demonstration,) = read_demonstrations([bag])
    kinds = [query.kind.value for query in demonstration.queries]
    assert kinds == ['feature_subset', 'label', 'demonstration', 'label']
    assert [query.turn for query in demonstration.queries] == [1, 2, 3, 5]
    trained = processes.run('train_weights', str(bag), '--method', 'choice', '--out', str(out))
    assert trained.returncode == 0, trained.stderr
    assert processes.run('replay', str(bag), '--check').returncode == 0
    processes.kill('learner')
    # Nobody is left to choose: the learner says so, and lives.
    processes.node('learner', task='prepare_lunch', seed=4, strategy='human')
    processes.wait_for_log('learner', 'the input has ended')


def test_a_demonstration_with_a_task_file_of_ones_own_can_be_learnt_from(
    graph: Any, processes: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The bag only names the task, whose file nobody else has; weights can be learnt from it all the same."""
    processes.namespace, examples = graph.namespace, ROOT / 'docs' / 'examples'
    for script in (examples / 'own_perception.py', Path(__file__).with_name('person.py')):
        processes.node(script.stem, program=[sys.executable, str(script)])
    graph.start(LearnerNode, task=str(examples / 'blobs.yaml'), strategy='expert', wait_for_recorder=True)
    recorder = graph.start(RecorderNode, bag=str(tmp_path / 'b'), until_done=True)
    graph.wait_for(lambda: recorder.machine.done, 'the end of the recording')
    graph.stop(recorder)
    for strategy in ('dt_task_env', 'value_per_cost'):
        arguments = [str(tmp_path / 'b'), '--strategy', strategy, '--out', str(tmp_path / f'{strategy}.yaml')]
        assert main(['train_weights', *arguments, '--method', 'choice']) == 0
        assert 'what the learner asks by itself is not known: b: no simulated world' in capsys.readouterr().out
        assert main(['train_weights', *arguments]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert "unknown task 'blobs'" in line
        assert 'use --method choice' in line


@pytest.mark.slow
def test_a_killed_recorder_loses_no_more_than_its_last_second(processes: Any, tmp_path: Path) -> None:
    """Otherwise half an hour of a person's time would be gone."""
    bag = tmp_path / 'bag'
    record(processes, bag)
    for name in ('perception', 'teacher'):
        processes.node(name, **WORLD)
    processes.node('learner', **WORLD, strategy='expert', budget=9.0, turns=12, turn_period=0.1)
    processes.wait_for_log('learner', 'turn 4:')
    # Longer than the time between two writes to the disk, so that turn 4 must be there.
    time.sleep(1.0)
    processes.kill('record')
    repaired = processes.run('record', '--repair', str(bag))
    assert repaired.returncode == 0, repaired.stderr
    assert 'messages kept' in repaired.stdout
    (demonstration,) = read_demonstrations([bag])
    assert len(demonstration.steps) >= 4
    out = tmp_path / 'w.yaml'
    assert processes.run('train_weights', str(bag), '--method', 'choice', '--out', str(out)).returncode == 0


@pytest.mark.parametrize(
    'signals',
    [
        pytest.param([signal.SIGINT], marks=pytest.mark.slow),
        [signal.SIGINT, signal.SIGINT],
        pytest.param([signal.SIGTERM], marks=pytest.mark.slow),
    ],
    ids=['INT', 'INT-INT', 'TERM'],
)
def test_a_recording_that_is_ended_is_whole(
    graph: Any, processes: Any, tmp_path: Path, signals: list[signal.Signals]
) -> None:
    """A recording that is ended as any other node is needs no repair."""
    bag = tmp_path / 'bag'
    recorder = processes.node('record', bag=str(bag))
    graph.start(LearnerNode, namespace=processes.namespace, task='prepare_lunch')
    processes.wait_for_log('record', 'from turn 1 on')
    for number in signals:
        os.killpg(recorder.pid, number)
    assert recorder.wait(DEADLINE) == 0, processes.log('record')
    assert 'Traceback' not in processes.log('record')
    # A turn that nobody serves is said again now and then.
    messages = read_bag(bag).messages
    assert {message.topic for message in messages} == {f'/{processes.namespace}/turn'}
    count = '1 message' if len(messages) == 1 else f'{len(messages)} messages'
    assert f'{bag}: {count}, the bag is whole' in processes.log('record').splitlines()


def test_a_recording_that_is_ended_before_its_episode_says_so(processes: Any, tmp_path: Path) -> None:
    """Otherwise a script that waits for a whole episode would go on with a part of it."""
    recorder = record(processes, tmp_path / 'bag', until_done=True)
    os.killpg(recorder.pid, signal.SIGINT)
    assert recorder.wait(DEADLINE) == 1
    assert processes.log('record').splitlines()[-1].startswith('record: ended before the episode was over')


@pytest.mark.parametrize('storage', ['mcap', pytest.param('sqlite3', marks=pytest.mark.slow)])
def test_a_recording_that_is_killed_is_repaired_without_ros(
    graph: Any, processes: Any, tmp_path: Path, storage: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Otherwise a demonstration with a person would be lost with the battery of the robot."""
    bag = tmp_path / 'bag'
    processes.node('record', bag=str(bag), storage=storage)
    graph.start(LearnerNode, namespace=processes.namespace, task='prepare_lunch')
    processes.wait_for_log('record', 'from turn 1 on')
    wait_for_content(bag, b'al_questioner/turn/1')
    processes.kill('record')
    no_ros = "import sys; sys.modules['rclpy'] = None; from al_questioner.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, '-c', no_ros, 'record', '--repair', str(bag)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=False)
    assert done.returncode == 0, done.stderr
    topics = [message.topic for message in read_bag(bag).messages]
    # A turn that nobody serves is said again now and then.
    assert set(topics) == {f'/{processes.namespace}/turn'}
    assert f'{len(topics)} messages kept' in done.stdout
    assert main(['record', '--repair', str(bag)]) == 0
    assert f'is whole: {len(topics)} messages' in capsys.readouterr().out


@pytest.mark.parametrize(
    ('arguments', 'reason'),
    [
        (['--repair', '/no/such/bag'], '/no/such/bag: there is no such bag'),
        (['--repair'], '--repair takes one bag, not 0'),
        (['--repair', 'a', 'b'], '--repair takes one bag, not 2'),
        (['--ros-args', '-p', 'storage:=bag'], "unknown storage 'bag'; known: mcap, sqlite3"),
        (['--ros-args', '-p', 'bag:=/proc/bag'], '/proc/bag: cannot be written'),
        (['bag'], "unexpected argument 'bag'"),
    ],
)
def test_unusable_input_of_record_ends_with_status_2_and_one_line(
    arguments: list[str], reason: str, refusal: Any
) -> None:
    """Otherwise a mistyped path would end in a traceback."""
    assert reason in refusal('record', *arguments)
