"""The real thing: processes that start, talk, and end when they are told to."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest

from al_questioner.imitation.bags import read_demonstrations
from al_questioner.recording import read_bag
from al_questioner.recording.bags import storage_files

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = 90
CROPS = ROOT.parent / 'shared' / 'data' / 'tabletop_rgbd' / 'crops' / 'rgbd-dataset'
SMALL = ['--task', 'prepare_lunch', '--budget', '6', '--turns', '7', '--seed', '4']
PAPER = ['--task', 'prepare_lunch', '--budget', '25', '--turns', '40', '--seed', '7']
STRATEGIES = [
    'u_sampling',
    'dt_iros',
    'dt_task',
    'dt_task_env',
    'value_per_cost',
    'u_sampling_fsq',
    'random_fsq',
    'farthest_fsq',
    'rarest_demo',
    'expert',
]


def environment() -> dict[str, str]:
    """Of a child: this checkout, and topics that stay on this machine."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))
    return {**os.environ, 'PYTHONPATH': path}


def al_questioner(*arguments: str) -> list[str]:
    return [sys.executable, '-m', 'al_questioner', *arguments]


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        al_questioner(*arguments), env=environment(), capture_output=True, text=True, timeout=DEADLINE, check=False
    )


def play(tmp_path: Path, name: str, *arguments: str) -> dict[str, object]:
    path = tmp_path / f'{name}.json'
    done = run('demo', *arguments, '--out', str(tmp_path / name), '--json', str(path))
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(path.read_text())


def test_three_processes_play_the_offline_episode(tmp_path: Path) -> None:
    """What is found offline would say nothing about the robot."""
    graph = play(tmp_path, 'graph', *SMALL, '--strategy', 'dt_task_env')
    assert graph['queries']
    assert graph == play(tmp_path, 'offline', *SMALL, '--strategy', 'dt_task_env', '--offline')
    assert {path.name for path in (tmp_path / 'graph' / 'logs').iterdir()} == {
        'learner.log',
        'perception.log',
        'teacher.log',
    }


@pytest.mark.slow
def test_one_process_plays_the_offline_episode(tmp_path: Path) -> None:
    """Nodes composed into one process would behave otherwise."""
    one = play(tmp_path, 'one', *SMALL, '--strategy', 'random_fsq', '--one-process', '--namespace', '/a/robot_1/')
    assert one == play(tmp_path, 'offline', *SMALL, '--strategy', 'random_fsq', '--offline')


@pytest.mark.slow
def test_processes_tune_as_the_offline_episode_does(tmp_path: Path) -> None:
    """The option would not reach the learner, or it would tune at other turns than the evaluation assumes."""
    tuned = [*SMALL, '--strategy', 'u_sampling_fsq', '--tune-every', '2']
    assert play(tmp_path, 'graph', *tuned) == play(tmp_path, 'offline', *tuned, '--offline')


@pytest.mark.slow
@pytest.mark.skipif(not CROPS.is_dir(), reason='the real RGB-D crops are not beside this checkout')
def test_real_crops_are_learnt_through_the_graph(tmp_path: Path) -> None:
    """The robot would learn from drawings alone."""
    crops = ['--task', 'tabletop', '--dataset', str(CROPS), '--budget', '15', '--turns', '20', '--seed', '3']
    graph = play(tmp_path, 'graph', *crops)
    assert graph == play(tmp_path, 'offline', *crops, '--offline')
    assert graph['final_accuracy'] > 2 / 5
    assert graph['dataset_report'][-1] == 'skipped in all: 0'


@pytest.mark.slow
@pytest.mark.parametrize('strategy', STRATEGIES)
def test_every_strategy_asks_the_same_with_and_without_ros(tmp_path: Path, strategy: str) -> None:
    """Some strategy would behave otherwise on the robot, over a whole episode of the paper's length."""
    graph = play(tmp_path, 'graph', *PAPER, '--strategy', strategy)
    assert graph == play(tmp_path, 'offline', *PAPER, '--strategy', strategy, '--offline')


class Processes:
    """Processes in sessions of their own, all gone after the test."""

    def __init__(self, folder: Path) -> None:
        self.namespace = f'test_{uuid.uuid4().hex[:12]}'
        self._folder = folder
        self._running: dict[str, subprocess.Popen[bytes]] = {}

    def start(self, name: str, command: list[str], typed: Path | None = None) -> subprocess.Popen[bytes]:
        with self.log_path(name).open('wb') as log, (typed or Path(os.devnull)).open('rb') as source:
            self._running[name] = subprocess.Popen(
                command,
                env=environment(),
                stdin=source,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        return self._running[name]

    def node(self, name: str, typed: Path | None = None, **parameters: object) -> subprocess.Popen[bytes]:
        arguments = ['--ros-args', '-r', f'__ns:=/{self.namespace}']
        for key, value in parameters.items():
            arguments += ['-p', f'{key}:={json.dumps(value)}']
        return self.start(name, al_questioner(name, *arguments), typed)

    def log_path(self, name: str) -> Path:
        return self._folder / f'{name}.log'

    def log(self, name: str) -> str:
        return self.log_path(name).read_text()

    def wait_for_log(self, name: str, text: str) -> None:
        end = time.monotonic() + DEADLINE
        while text not in self.log(name):
            assert time.monotonic() < end, f'{name} never printed {text!r}: {self.log(name)}'
            assert self._running[name].poll() is None, f'{name} ended: {self.log(name)}'
            time.sleep(0.05)

    def close(self) -> None:
        for process in self._running.values():
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


@pytest.fixture
def processes(tmp_path: Path) -> Iterator[Processes]:
    result = Processes(tmp_path)
    try:
        yield result
    finally:
        result.close()


@pytest.mark.parametrize('interrupts', [pytest.param(1, marks=pytest.mark.slow), 2])
@pytest.mark.parametrize('name', ['perception', 'learner', 'teacher'])
def test_nodes_end_cleanly_when_interrupted(processes: Processes, name: str, interrupts: int) -> None:
    """Ctrl-C, which `ros2 launch` sends twice, would leave a traceback or a process behind."""
    process = processes.node(name, task='prepare_lunch')
    processes.wait_for_log(name, 'is up')
    for _ in range(interrupts):
        os.killpg(process.pid, signal.SIGINT)
    assert process.wait(DEADLINE) == 0, processes.log(name)
    assert 'Traceback' not in processes.log(name)


@pytest.mark.parametrize(
    ('name', 'parameter', 'reason'),
    [
        ('learner', 'strategy:=clever', 'unknown strategy'),
        ('learner', 'budget:=', 'unusable ROS arguments'),
        ('learner', 'budget', 'unusable ROS arguments'),
        ('learner', 'bugdet:=3', 'unknown parameter bugdet'),
        ('learner', 'budget:=-1.0', 'budget must be 0 or more, not -1.0'),
        ('teacher', 'wrong_rate:=.nan', 'wrong_rate must be a finite number'),
        ('perception', 'task:=prepare_luch', 'unknown task'),
    ],
)
def test_unusable_parameters_end_with_status_2_and_one_line(name: str, parameter: str, reason: str) -> None:
    """A mistyped parameter would end in a traceback, or be ignored."""
    done = run(name, '--ros-args', '-p', parameter)
    assert done.returncode == 2
    assert reason in done.stderr
    assert done.stderr.count('\n') == 1


def test_a_robots_own_perception_teaches_the_learner(processes: Processes) -> None:
    """The example that users copy for their own robot would not work."""
    example = ROOT / 'docs' / 'examples' / 'own_perception.py'
    remap = ['--ros-args', '-r', f'__ns:=/{processes.namespace}']
    processes.start('own_perception', [sys.executable, str(example), *remap])
    task = str(ROOT / 'docs' / 'examples' / 'blobs.yaml')
    learner = processes.node('learner', task=task, strategy='random_fsq', view_tolerance=0.5)
    processes.start('person', [sys.executable, str(Path(__file__).with_name('person.py')), *remap])
    processes.wait_for_log('learner', 'the episode is over: 6 of 6 spent')
    os.killpg(learner.pid, signal.SIGINT)
    assert learner.wait(DEADLINE) == 0


def test_an_unusable_namespace_is_named(tmp_path: Path) -> None:
    """A mistyped namespace would end in warnings of the middleware."""
    done = run('demo', *SMALL, '--out', str(tmp_path), '--namespace', 'not a namespace')
    assert done.returncode == 2
    assert 'namespace' in done.stderr
    assert done.stderr.count('\n') == 1


@pytest.mark.slow
def test_a_recorded_demo_is_a_demonstration(tmp_path: Path) -> None:
    """The bags that people share would not be what the real graph did."""
    bag = tmp_path / 'bag'
    shown = ['--task', 'prepare_lunch', '--strategy', 'expert', '--budget', '6', '--turns', '8', '--seed', '4']
    episode = play(tmp_path, 'graph', *shown, '--record', str(bag))
    (demonstration,) = read_demonstrations([bag])
    assert len(demonstration.steps) == 8
    assert [query.turn for query in demonstration.queries] == [query['turn'] for query in episode['queries']]


@pytest.mark.slow
def test_a_person_shows_how_to_ask(processes: Processes, tmp_path: Path) -> None:
    """A person's way of asking could not be recorded, or not be learnt from."""
    bag, typed, out = tmp_path / 'bag', tmp_path / 'typed', tmp_path / 'w.yaml'
    typed.write_text('f\n3\nbeverage\n\nno such question\n5\n')
    recorder = processes.node('record', bag=str(bag), until_done=True)
    processes.wait_for_log('record', 'recording to')
    world = {'task': 'prepare_lunch', 'seed': 4, 'wait_for_recorder': True}
    processes.node('perception', **world)
    processes.node('teacher', **world)
    learner = processes.node('learner', typed, **world, strategy='human', budget=9.0, turns=5)
    assert recorder.wait(DEADLINE) == 0, processes.log('record')
    assert 'is no question' in processes.log('learner')
    (demonstration,) = read_demonstrations([bag])
    kinds = [query.kind.value for query in demonstration.queries]
    assert kinds == ['feature_subset', 'label', 'demonstration', 'label']
    assert [query.turn for query in demonstration.queries] == [1, 2, 3, 5]
    trained = run('train_weights', str(bag), '--method', 'choice', '--out', str(out))
    assert trained.returncode == 0, trained.stderr
    assert run('replay', str(bag), '--check').returncode == 0
    os.killpg(learner.pid, signal.SIGKILL)
    learner.wait()
    # Nobody is left to choose: the learner says so, and lives.
    processes.node('learner', task='prepare_lunch', seed=4, strategy='human')
    processes.wait_for_log('learner', 'the input has ended')


@pytest.mark.slow
def test_a_killed_recorder_loses_no_more_than_its_last_second(processes: Processes, tmp_path: Path) -> None:
    """Half an hour of a person's time would be gone."""
    bag = tmp_path / 'bag'
    recorder = processes.node('record', bag=str(bag))
    processes.wait_for_log('record', 'recording to')
    world = {'task': 'prepare_lunch', 'seed': 4, 'wait_for_recorder': True}
    processes.node('perception', **world)
    processes.node('teacher', **world)
    processes.node('learner', **world, strategy='expert', budget=9.0, turns=12, turn_period=0.1)
    processes.wait_for_log('learner', 'turn 4:')
    # Longer than the time between two writes to the disk, so that turn 4 must be there.
    time.sleep(1.0)
    os.killpg(recorder.pid, signal.SIGKILL)
    recorder.wait()
    repaired = run('record', '--repair', str(bag))
    assert repaired.returncode == 0, repaired.stderr
    assert 'messages kept' in repaired.stdout
    (demonstration,) = read_demonstrations([bag])
    assert len(demonstration.steps) >= 4
    out = tmp_path / 'w.yaml'
    assert run('train_weights', str(bag), '--method', 'choice', '--out', str(out)).returncode == 0


@pytest.mark.slow
def test_a_demo_overwrites_no_recording(tmp_path: Path) -> None:
    """A demonstration cannot be given twice."""
    done = run('demo', *SMALL, '--out', str(tmp_path / 'out'), '--record', str(tmp_path))
    assert done.returncode == 2
    assert done.stderr == f'demo: --record: {tmp_path} exists already; a bag is never overwritten\n'


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
    processes: Processes, tmp_path: Path, signals: list[signal.Signals]
) -> None:
    """Whoever ends a recording as they end any other node would have to repair it."""
    bag = tmp_path / 'bag'
    recorder = processes.node('record', bag=str(bag))
    processes.node('learner', task='prepare_lunch')
    processes.wait_for_log('record', 'from turn 1 on')
    for number in signals:
        os.killpg(recorder.pid, number)
    assert recorder.wait(DEADLINE) == 0, processes.log('record')
    assert 'Traceback' not in processes.log('record')
    assert [message.topic for message in read_bag(bag).messages] == [f'/{processes.namespace}/turn']


def test_a_recording_that_is_ended_before_its_episode_says_so(processes: Processes, tmp_path: Path) -> None:
    """A script that waits for a whole episode would go on with a part of it."""
    recorder = processes.node('record', bag=str(tmp_path / 'bag'), until_done=True)
    processes.wait_for_log('record', 'recording to')
    os.killpg(recorder.pid, signal.SIGINT)
    assert recorder.wait(DEADLINE) == 1
    assert processes.log('record').splitlines()[-1].startswith('record: ended before the episode was over')


@pytest.mark.parametrize('storage', ['mcap', pytest.param('sqlite3', marks=pytest.mark.slow)])
def test_a_recording_that_is_killed_is_repaired_without_ros(processes: Processes, tmp_path: Path, storage: str) -> None:
    """A demonstration with a person would be lost with the battery of the robot."""
    bag = tmp_path / 'bag'
    recorder = processes.node('record', bag=str(bag), storage=storage)
    processes.node('learner', task='prepare_lunch')
    processes.wait_for_log('record', 'from turn 1 on')
    wait_for_content(bag, b'al_questioner/turn/1')
    os.killpg(recorder.pid, signal.SIGKILL)
    recorder.wait()
    no_ros = "import sys; sys.modules['rclpy'] = None; from al_questioner.cli import main; sys.exit(main(sys.argv[1:]))"
    for said in ('1 messages kept', 'is whole: 1 messages'):
        done = subprocess.run(
            [sys.executable, '-c', no_ros, 'record', '--repair', str(bag)],
            env=environment(),
            capture_output=True,
            text=True,
            timeout=DEADLINE,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert said in done.stdout
    assert [message.topic for message in read_bag(bag).messages] == [f'/{processes.namespace}/turn']


def wait_for_content(bag: Path, content: bytes) -> None:
    """Wait until a bag's file of messages, not its journal, has this on the disk."""
    end = time.monotonic() + DEADLINE
    while not any(content in file.read_bytes() for file in storage_files(bag)):
        assert time.monotonic() < end, f'{bag} never held {content!r}'
        time.sleep(0.05)


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
def test_unusable_input_of_record_ends_with_status_2_and_one_line(arguments: list[str], reason: str) -> None:
    """A mistyped path would end in a traceback."""
    done = run('record', *arguments)
    assert done.returncode == 2, done.stderr
    assert reason in done.stderr
    assert done.stderr.count('\n') == 1
