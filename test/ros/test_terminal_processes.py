"""The teacher's process before perception and a learner: a person at a pseudo-terminal, or a script at a pipe."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import uuid
from collections.abc import Callable
from typing import Any

import pytest

DEADLINE = 120
EPISODE = {'strategy': 'random_fsq', 'budget': 5.0, 'turns': 6}
OVER = 'The episode is over: 5 of 5 spent on 4 questions.'


def teacher(namespace: str, **parameters: object) -> list[str]:
    command = [sys.executable, '-m', 'al_questioner', 'teacher', '--ros-args', '-r', f'__ns:=/{namespace}']
    for key, value in {'mode': 'terminal', **parameters}.items():
        command += ['-p', f'{key}:={value}']
    return command


def test_a_person_teaches_at_a_terminal_quits_and_comes_back(
    graph: Any, open_terminal: Callable[..., Any], capfd: pytest.CaptureFixture[str]
) -> None:
    """Otherwise the one thing that the whole program is for would not work."""
    graph.start_robot(**EPISODE)

    def open_one(**options: Any) -> Any:
        return open_terminal(teacher(graph.namespace, teacher_id='anna'), **options)

    terminal = open_one()
    terminal.wait_for('Which properties matter')
    terminal.press('1 \r', until='tick what matters')
    terminal.press('12\r', until='Noted: what matters is colour, size.')
    asked = terminal.wait_for(lambda text: re.search(r'What is object (\d+)\?.*\[\1\].*q quit', text, re.DOTALL))
    (object_id,) = re.findall(r'What is object (\d+)\?', asked)
    terminal.wait_for('▀')
    terminal.press('q')
    assert terminal.status() == 0
    assert f'Left open: What is object {object_id}? (q2)' in terminal.text
    terminal = open_one(columns=60)
    terminal.wait_for(lambda text: f'What is object {object_id}?' in text and 'what matters is colour' in text)
    # What was said before this program began can be taken back, too.
    terminal.press('z', until='Correction of: what matters is colour, size')
    terminal.press('z', until=f'What is object {object_id}?')
    terminal.press('f', until=f'Noted: object {object_id} is fruit.')
    for key, noted in (('?', 'you do not know'), ('n', 'The episode is over')):
        terminal.wait_for('[a] snack')
        terminal.press(key, until=noted)
    terminal.press('z', until='Correction of: object')
    terminal.press('b', until='is beverage instead')
    terminal.press('q')
    assert terminal.status() == 0
    assert OVER in ' '.join(terminal.text.split())
    said: list[str] = []

    def log() -> str:
        said.append(capfd.readouterr().err)
        return ''.join(said)

    # The learner acknowledges an answer before it logs it.
    graph.wait_for(lambda: 'anna now says beverage' in log(), 'the correction in the log')
    assert 'anna says colour, size' in log()
    assert 'Traceback' not in log()


def test_a_script_teaches_through_a_pipe(graph: Any) -> None:
    """Otherwise nobody could try a robot without sitting down before it."""
    graph.start_robot(**EPISODE)
    done = subprocess.run(
        teacher(graph.namespace, teacher_id='script'),
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


@pytest.mark.parametrize('number', [signal.SIGINT, pytest.param(signal.SIGTERM, marks=pytest.mark.slow)])
def test_a_signal_gives_the_terminal_back(open_terminal: Callable[..., Any], number: signal.Signals) -> None:
    """Otherwise a shell would stay without echo when a launch file or a supervisor ends the node."""
    terminal = open_terminal(teacher(f'test_{uuid.uuid4().hex[:12]}'))
    before = terminal.local_modes()
    terminal.wait_for('Waiting for a robot that asks')
    assert terminal.local_modes() != before
    terminal.child.kill(number)
    terminal.wait_for('start this program again')
    assert terminal.local_modes() == before
    assert terminal.status() == 0
    assert 'Traceback' not in terminal.text
