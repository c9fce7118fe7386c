"""The real thing: perception and learner, and a person at a pseudo-terminal or a script at a pipe."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import uuid
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
DEADLINE = 120
WORLD = {'task': 'prepare_lunch', 'seed': 4}
EPISODE = {**WORLD, 'strategy': 'random_fsq', 'budget': 5.0, 'turns': 6}
OVER = 'The episode is over: 5 of 5 spent on 4 questions.'


def environment() -> dict[str, str]:
    """Of a child: this checkout, and topics that stay on this machine."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))
    return {**os.environ, 'PYTHONPATH': path}


def node(name: str, namespace: str, **parameters: object) -> list[str]:
    command = [sys.executable, '-m', 'al_questioner', name, '--ros-args', '-r', f'__ns:=/{namespace}']
    for key, value in parameters.items():
        command += ['-p', f'{key}:={json.dumps(value)}']
    return command


@pytest.fixture
def namespace(tmp_path: Path) -> Iterator[str]:
    """Where perception and a learner of a short episode are up."""
    name = f'test_{uuid.uuid4().hex[:12]}'
    running = []
    for kind, parameters in (('perception', WORLD), ('learner', EPISODE)):
        with (tmp_path / f'{kind}.log').open('wb') as log:
            command = node(kind, name, **parameters)
            running.append(
                subprocess.Popen(
                    command,
                    env=environment(),
                    stdin=subprocess.DEVNULL,
                    stdout=log,
                    stderr=subprocess.STDOUT,
                    start_new_session=True,
                )
            )
    try:
        yield name
    finally:
        for process in running:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def test_a_person_teaches_at_a_terminal_quits_and_comes_back(
    namespace: str, open_terminal: Callable[..., Any], tmp_path: Path
) -> None:
    """The one thing that the whole program is for would not work."""

    def open_one(**options: Any) -> Any:
        command = node('teacher', namespace, mode='terminal', teacher_id='anna')
        return open_terminal(command, environment=environment(), **options)

    terminal = open_one()
    terminal.wait_for('Which properties matter')
    terminal.press('1 \r')
    terminal.wait_for('tick what matters')
    terminal.press('12\r')
    terminal.wait_for('Noted: what matters is colour, size.')
    asked = terminal.wait_for(lambda text: re.search(r'What is object (\d+)\?.*\[\1\].*q quit', text, re.DOTALL))
    (object_id,) = re.findall(r'What is object (\d+)\?', asked)
    terminal.wait_for('▀')
    terminal.press('q')
    assert terminal.status() == 0
    assert f'Left open: What is object {object_id}? (q2)' in terminal.text
    terminal = open_one(columns=60)
    terminal.wait_for(lambda text: f'What is object {object_id}?' in text and 'what matters is colour' in text)
    # What was said before this program began can be taken back, too.
    terminal.press('z')
    terminal.wait_for('Correction of: what matters is colour, size')
    terminal.press('z')
    terminal.wait_for(f'What is object {object_id}?')
    terminal.press('f')
    terminal.wait_for(f'Noted: object {object_id} is fruit.')
    for key, noted in (('?', 'you do not know'), ('n', 'The episode is over')):
        terminal.wait_for('[a] snack')
        terminal.press(key)
        terminal.wait_for(noted)
    terminal.press('z')
    terminal.wait_for('Correction of: object')
    terminal.press('b')
    terminal.wait_for('is beverage instead')
    terminal.press('q')
    assert terminal.status() == 0
    assert OVER in ' '.join(terminal.text.split())
    log = (tmp_path / 'learner.log').read_text()
    assert 'anna says colour, size' in log
    assert 'anna now says beverage' in log
    assert 'Traceback' not in log


def test_a_script_teaches_through_a_pipe(namespace: str) -> None:
    """Nobody could try a robot without sitting down before it."""
    done = subprocess.run(
        node('teacher', namespace, mode='terminal', teacher_id='script'),
        env=environment(),
        input='pudding\ncolour,size\nfruit\n?\nskip\n',
        capture_output=True,
        text=True,
        timeout=DEADLINE,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert len(done.stdout.splitlines()) == 5
    assert done.stdout.startswith('q1: Which properties matter')
    assert "'pudding' does not answer" in done.stderr
    assert OVER in done.stderr
    assert 'Traceback' not in done.stderr


@pytest.mark.parametrize('number', [signal.SIGTERM, signal.SIGINT])
def test_a_signal_gives_the_terminal_back(open_terminal: Callable[..., Any], number: signal.Signals) -> None:
    """A shell would stay without echo when a launch file or a supervisor ends the node."""
    command = node('teacher', f'test_{uuid.uuid4().hex[:12]}', mode='terminal')
    terminal = open_terminal(command, environment=environment())
    before = terminal.local_modes()
    terminal.wait_for('Waiting for a robot that asks')
    assert terminal.local_modes() != before
    terminal.child.kill(number)
    terminal.wait_for('start this program again')
    assert terminal.local_modes() == before
    assert terminal.status() == 0
    assert 'Traceback' not in terminal.text
