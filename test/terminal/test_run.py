"""A person at a real pseudo-terminal, and a script at a pipe, before a robot without ROS."""

from __future__ import annotations

import shlex
import signal
import subprocess
import sys
import termios
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

DEADLINE = 60
CORRECTED = ['q1 answered fruit False', 'q1 answered snack True', 'q2 answered 12 False']


def robot(file: Path, *options: str) -> list[str]:
    return [sys.executable, str(Path(__file__).with_name('robot.py')), str(file), *options]


@pytest.fixture
def open_robot(open_terminal: Callable[..., Any], tmp_path: Path) -> Callable[..., Any]:
    """A robot in a pseudo-terminal, once it has asked."""

    def open_one(*options: str, **settings: Any) -> Any:
        environment = {'NO_COLOR': None, **settings.pop('environment', {})}
        terminal = open_terminal(robot(tmp_path / 'said', *options), environment=environment, **settings)
        terminal.before = terminal.local_modes()
        terminal.wait_for('What is object 7?')
        return terminal

    return open_one


def said(tmp_path: Path) -> list[str]:
    file = tmp_path / 'said'
    return file.read_text().splitlines() if file.exists() else []


@pytest.mark.parametrize(
    ('environment', 'columns'),
    [
        ({}, 80),
        ({'NO_COLOR': '1'}, 40),
        ({'TERM': 'vt100'}, 80),
        ({'COLORTERM': 'truecolor'}, 40),
        pytest.param({}, 40, marks=pytest.mark.slow),
        pytest.param({'NO_COLOR': '1'}, 80, marks=pytest.mark.slow),
        pytest.param({'TERM': 'vt100'}, 40, marks=pytest.mark.slow),
        pytest.param({'COLORTERM': 'truecolor'}, 80, marks=pytest.mark.slow),
    ],
    ids=str,
)
def test_keys_answer_every_kind_of_question(
    open_robot: Callable[..., Any], tmp_path: Path, environment: dict[str, str], columns: int
) -> None:
    """Otherwise a person could not teach at their terminal."""
    terminal = open_robot(columns=columns, environment=environment)
    coloured = not {'NO_COLOR', 'TERM'} & environment.keys()
    terminal.wait_for('▀' if coloured else 'q quit')
    assert ('▀' in terminal.text) == coloured
    terminal.press('x', until='is the key of no answer')
    terminal.press('f', until='Can you show me a snack?')
    terminal.press('12', until='Object 12:')
    terminal.press('\r', until='Which properties matter?')
    terminal.press(' \x1b[C ', until=lambda text: text.count('[x]') == 2)
    terminal.press('\r', until='The episode is over.')
    terminal.press('q')
    assert terminal.status() == 0
    assert 'The episode is over: 3 of 5 spent on 3' in ' '.join(terminal.text.split())
    assert said(tmp_path) == ['q1 answered fruit False', 'q2 answered 12 False', "q3 answered ('colour', 'size') False"]


def test_an_answer_is_taken_back_and_help_is_shown(open_robot: Callable[..., Any], tmp_path: Path) -> None:
    """A slip of the finger can be corrected."""
    terminal = open_robot()
    terminal.press('f', until='Noted: object 7 is fruit.')
    terminal.press('z', until='Correction of: object 7 is fruit')
    terminal.press('h', until='You teach a robot what things are.')
    terminal.press('h', until='[a] snack')
    terminal.press(':Snack\r', until='Noted: object 7 is snack instead.')
    terminal.wait_for('Can you show me a snack?')
    terminal.press('q')
    assert terminal.status() == 0
    assert said(tmp_path) == ['q1 answered fruit False', 'q1 answered snack True']


@pytest.mark.parametrize('way', ['q', '\x03', '\x04', 'SIGTERM', 'SIGINT'])
def test_however_it_ends_the_terminal_is_as_it_was(open_robot: Callable[..., Any], way: str) -> None:
    """Otherwise the shell would stay without echo, or on the other screen."""
    terminal = open_robot()
    assert not terminal.local_modes() & termios.ECHO
    if way.startswith('SIG'):
        terminal.child.kill(getattr(signal, way))
    else:
        terminal.press(way)
    terminal.wait_for('Left open: What is object 7? (q1)')
    assert terminal.raw.count(b'\x1b[?1049h') == terminal.raw.count(b'\x1b[?1049l') == 1
    assert terminal.raw.rindex(b'\x1b[?25h') > terminal.raw.rindex(b'\x1b[?25l')
    assert terminal.local_modes() == terminal.before
    assert terminal.status() == 0


def test_control_z_suspends_and_the_question_comes_back(open_terminal: Callable[..., Any], tmp_path: Path) -> None:
    """A person can look at something else without quitting, and the shell has its echo meanwhile."""
    shell = open_terminal(['bash', '--norc', '-i'], environment={'NO_COLOR': None, 'PS1': 'shell> ', 'HISTFILE': None})
    shell.wait_for('shell>')
    before = shell.local_modes()
    for command in (shlex.join(robot(tmp_path / 'said')), 'fg'):
        # Whatever the robot has said on the screen is out of sight.
        shell.press('clear\r', until=lambda text: text.strip() == 'shell>')
        shell.press(f'{command}\r', until='What is object 7?')
        shell.wait_for('q quit')
        shell.press('\x1a', until=lambda text: 'Stopped' in text and text.rstrip().endswith('shell>'))
        assert 'q quit' not in shell.text
        assert shell.local_modes() == before
    shell.press('fg\r', until='q quit')
    shell.press('f', until='Noted: object 7 is fruit.')
    shell.press('q', until='Left open: Can you show me a snack?')
    shell.press('exit\r')
    assert shell.status() == 0
    assert said(tmp_path) == ['q1 answered fruit False']


def test_what_nodes_log_meanwhile_is_shown_when_the_screen_has_gone(open_robot: Callable[..., Any]) -> None:
    """Otherwise warnings would be written across the question, or be lost."""
    terminal = open_robot()
    terminal.press('f', until='Noted: object 7 is fruit.')
    assert b'disk' not in terminal.raw
    terminal.press('q', until='[WARN] the disk is nearly full')
    assert '[INFO]' not in terminal.text
    assert terminal.status() == 0


def test_an_answer_that_was_not_confirmed_is_said_to_be_so(open_robot: Callable[..., Any]) -> None:
    """Otherwise a person would go home in the belief that the robot has heard them."""
    terminal = open_robot('--deaf')
    terminal.press('f', until='telling the robot')
    terminal.press('q', until='The robot has not confirmed your answer')
    assert terminal.status() == 0


def test_a_terminal_that_changes_its_size_is_filled_anew(open_robot: Callable[..., Any]) -> None:
    """Otherwise the keys would be out of sight until the end."""
    terminal = open_robot()
    terminal.screen.resize(24, 50)
    terminal.child.setwinsize(24, 50)
    terminal.wait_for(lambda text: '─' * 50 in text.splitlines()[2] or '─' * 50 in text.splitlines()[1])
    terminal.wait_for('q quit')


def test_a_terminal_that_can_do_nothing_is_talked_to_in_lines(open_robot: Callable[..., Any], tmp_path: Path) -> None:
    """Otherwise a person in an editor's shell would see codes instead of questions."""
    terminal = open_robot(environment={'TERM': 'dumb'})
    line = 'q1: What is object 7? [snack fruit none ? skip] (costs 1, which leaves 4 of 5 of the budget; turns left 2)'
    assert ''.join(terminal.text.splitlines()).startswith(line)
    terminal.press('fruit\r', until='q2: Can you show me a snack?')
    terminal.press('\x04')
    assert terminal.status() == 0
    assert b'\x1b' not in terminal.raw


def piped(tmp_path: Path, text: str, *options: str, stdin: Any = None) -> subprocess.CompletedProcess[str]:
    source = {'input': text} if stdin is None else {'stdin': stdin}
    command = robot(tmp_path / 'said', *options)
    return subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, check=True, **source)


def test_a_script_answers_a_line_for_each_question(tmp_path: Path) -> None:
    """A test of a robot can automate the person."""
    done = piped(tmp_path, 'pudding\nfruit\nundo\nsnack\n#12\n\ncolour, size')
    label, shown, subset = 'q1: What is object 7? ', 'q2: Can you show me a snack? ', 'q3: Which properties matter? '
    correction = label.replace('q1', 'q1: correction')
    asked = [line.split('[')[0] for line in done.stdout.splitlines()]
    assert asked == [label, label, shown, correction, shown, subset, subset]
    errors = [line for line in done.stderr.splitlines() if not line.startswith('[')]
    assert errors[0].startswith("'pudding' does not answer")
    assert errors[1:4] == ['Noted: object 7 is fruit.', 'Noted: object 7 is snack instead.', 'Noted: snack: object 12.']
    assert errors[4] == 'an empty line is no answer'
    assert errors[-1] == 'The episode is over: 3 of 5 spent on 3 questions. Thank you.'
    assert said(tmp_path) == [*CORRECTED, "q3 answered ('colour', 'size') False"]


def test_undo_in_a_script_waits_until_the_answer_is_taken(tmp_path: Path) -> None:
    """Otherwise the answer after a dropped `undo` would be told as that to the next question: a wrong label."""
    done = piped(tmp_path, 'fruit\nundo\nsnack\n#12\ncolour\nundo\nsize\n', '--slow')
    assert 'on its way' not in done.stderr
    assert said(tmp_path) == [*CORRECTED, "q3 answered ('colour',) False", "q3 answered ('size',) True"]


@pytest.mark.parametrize('text', ['', 'help\n', 'quit\nfruit\n', None])
def test_the_end_of_the_input_or_quit_leaves_the_question_open(tmp_path: Path, text: str | None) -> None:
    """A script learns that the robot still waits, and does not wait for ever under `ros2 launch`, without input."""
    done = piped(tmp_path, text or '', stdin=subprocess.DEVNULL if text is None else None)
    assert done.stderr.splitlines()[-1].startswith('Left open: What is object 7? (q1)')
    assert not said(tmp_path)


@pytest.mark.parametrize(
    'content', [b'\xff\xfe\x00\x1b[2J\n', b'a' * 100_000, b'\n' * 50], ids=['bytes', 'long', 'blank']
)
def test_rubbish_on_the_input_is_explained(tmp_path: Path, content: bytes) -> None:
    """Otherwise a file that is no text would end in a traceback, or reach the terminal as it is."""
    file = tmp_path / 'rubbish'
    file.write_bytes(content)
    with file.open('rb') as stdin:
        done = piped(tmp_path, '', stdin=stdin)
    assert 'Traceback' not in done.stderr
    assert '\x1b' not in done.stderr
    assert len(done.stderr.splitlines()) > 1
    assert not said(tmp_path)
