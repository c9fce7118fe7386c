"""Behaviour of every executable at once, and with any kind of output."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from al_questioner.cli import EXECUTABLES
from shared.checkout import ROOT

HEAVY = ('scipy', 'numba', 'matplotlib', 'rclpy', 'joblib', 'rosbags', 'prompt_toolkit', 'al_questioner.ros.node')
"""Modules that take long to import."""
LOADED = 'import sys; print(*sorted(set(sys.argv[1].split()) & sys.modules.keys()), file=sys.stderr)'
MODULE = [sys.executable, '-m', 'al_questioner']


@pytest.fixture(autouse=True)
def _interrupts_are_heard() -> Iterator[None]:
    """Interrupts are restored, which a process that a shell starts in the background ignores."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def loaded(code: str) -> list[str]:
    """Return the heavy modules that a piece of Python leaves loaded."""
    done = subprocess.run(
        [sys.executable, '-c', f'{code}\n{LOADED}', ' '.join(HEAVY)], capture_output=True, text=True, check=True
    )
    return done.stderr.splitlines()[-1].split()


def calls(*commands: list[str]) -> str:
    """Code that calls each of these command lines."""
    return (
        'from al_questioner.cli import main\n'
        f'for command in {json.dumps(commands)}:\n'
        '    try: main(command)\n'
        '    except SystemExit: pass\n'
    )


def test_help_and_wrong_options_wait_for_nothing() -> None:
    """Otherwise `learner --help` would take seconds for what no help needs."""
    helps = [[name, '--help'] for name in EXECUTABLES]
    wrong = [[name, '--nonsense'] for name in EXECUTABLES]
    assert loaded(calls(['--help'], *helps, *wrong)) == []


def test_values_that_are_refused_wait_for_little() -> None:
    """A mistyped name is refused before the slow imports for pictures."""
    commands = [
        ['demo', '--strategy', 'nonsense'],
        ['demo', '--task', 'nonsense'],
        ['demo', '--offline', '--budget', '-1'],
        ['train_weights', '/no/such/bag', '--out', '/no/such/folder/weights.yaml'],
        ['session', '/no/such/folder'],
    ]
    assert {'matplotlib', 'numba', 'rclpy'}.isdisjoint(loaded(calls(*commands)))
    experiments = [['experiment', '--strategy', 'nonsense'], ['experiment', '--task', 'nonsense']]
    assert loaded(calls(*experiments)) == []


def test_a_learner_in_python_is_there_at_once_and_a_session_shown_without_pictures_tests_and_ros() -> None:
    assert loaded('import al_questioner.questioning') == []
    assert {'matplotlib', 'rclpy', 'joblib'}.isdisjoint(loaded('import al_questioner.commands.session.command'))


def ended(
    *command: str, status: int, encoding: str = 'utf-8', stdout: int = subprocess.PIPE, **environment: str
) -> tuple[str, str]:
    """Return the output to either side of an executable, run in the checkout, that ends with a status."""
    given = {**os.environ, 'PYTHONIOENCODING': encoding, **environment}
    done = subprocess.run([*MODULE, *command], env=given, cwd=ROOT, stdout=stdout, stderr=subprocess.PIPE)
    error = done.stderr.decode(encoding)
    assert done.returncode == status, error
    assert 'Traceback' not in error
    return (done.stdout or b'').decode(encoding), error


def test_what_a_terminal_has_no_character_for_is_replaced(tmp_path: Path) -> None:
    """Otherwise an episode would be lost at its last word, for a dot between two names."""
    given = ['--offline', '--turns', '1', '--budget', '1', '--strategy', 'random_fsq', '--out', str(tmp_path)]
    printed, _ = ended('demo', *given, status=0, encoding='ascii')
    assert 'kitchen_table ? random_fsq' in printed
    printed, _ = ended('replay', '--help', status=0, encoding='latin-1')
    assert 'pause · right' in printed
    _, error = ended('session', 'おやつ', status=2, encoding='latin-1')
    assert error.count('\n') == 1


@pytest.mark.parametrize(
    'command', [['--help'], ['replay', '--help'], ['replay', 'expert_0', '--check'], ['record', '--repair', 'expert_0']]
)
def test_a_reader_who_has_gone_is_no_error(command: list[str]) -> None:
    """Otherwise `--help | head` would end in a complaint of Python's."""
    reader, writer = os.pipe()
    os.close(reader)
    try:
        _, error = ended(*command, status=128 + signal.SIGPIPE, stdout=writer)
    finally:
        os.close(writer)
    assert error == ''


def test_output_that_there_is_no_room_for_is_one_line() -> None:
    with Path('/dev/full').open('wb') as full:
        _, error = ended('--help', status=2, stdout=full.fileno())
    assert error == 'al_questioner: the output, or a file, cannot be written (No space left on device)\n'


@pytest.mark.parametrize(
    ('module', 'command'),
    [
        ('numpy', ['--help']),
        ('yaml', ['learner']),
        ('rclpy', ['learner']),
        ('sensor_msgs', ['perception']),
        ('rclpy', ['demo']),
        ('numba', ['demo', '--offline']),
        ('rosbags', ['replay', 'bags/expert_0', '--check']),
    ],
)
def test_an_interrupt_while_modules_are_imported_ends_quietly(tmp_path: Path, module: str, command: list[str]) -> None:
    """Otherwise Ctrl-C in the first seconds would be a traceback, or be taken for a module that is missing."""
    (tmp_path / f'{module}.py').write_text(
        'import os, signal\n'
        'try:\n'
        '    os.kill(os.getpid(), signal.SIGINT)\n'
        'except KeyboardInterrupt as error:\n'
        '    raise ImportError("as compiled modules say") from error\n'
        'raise ImportError("nobody was interrupted")\n'
    )
    path = os.pathsep.join((str(tmp_path), os.environ['PYTHONPATH']))
    assert ended(*command, status=130, PYTHONPATH=path)[1] == ''


def test_an_interrupt_that_is_ignored_in_the_background_stays_ignored() -> None:
    """Otherwise `nohup` and `&` in a script would no longer shield an experiment."""
    code = (
        'import signal; from al_questioner.support import interrupts\n'
        'interrupts.install(); print(signal.getsignal(2).name)'
    )
    ignoring = f'trap "" INT; exec {sys.executable} -c "{code}"'
    done = subprocess.run(['sh', '-c', ignoring], capture_output=True, text=True, check=True)
    assert done.stdout == 'SIG_IGN\n'


def test_a_full_disk_under_a_demo_is_one_line(tmp_path: Path) -> None:
    """Otherwise its result would be lost, and empty files left."""
    out = tmp_path / 'out'
    limited = f'ulimit -f 4; exec {sys.executable} -m al_questioner demo --offline --turns 1 --strategy random_fsq'
    done = subprocess.run(
        ['bash', '-c', f'{limited} --out {out} --json {out}/episode.json'], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr.count('\n')) == (2, 1), done.stderr
    assert 'cannot be written (File too large)' in done.stderr
    assert 'accuracy on held-out images' in done.stdout
    # What there is room for is whole, and of the rest there is nothing.
    assert [path.name for path in out.iterdir()] == ['episode.json']
    assert json.loads((out / 'episode.json').read_text())['turns'] == 1
