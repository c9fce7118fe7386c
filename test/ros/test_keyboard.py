"""Keys from a terminal, and the terminal afterwards."""

from __future__ import annotations

import io
import os
import pty
import sys
import termios
import threading
from collections.abc import Callable, Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from al_questioner.ros.keyboard import Keys, split_keys

DEADLINE = 30.0


@pytest.mark.parametrize(
    ('text', 'keys', 'rest'),
    [
        ('n', ['n'], ''),
        (' sq', [' ', 's', 'q'], ''),
        ('\x1b[A\x1b[B\x1b[C\x1b[D', ['up', 'down', 'right', 'left'], ''),
        ('\x1bOA\x1bOC', ['up', 'right'], ''),
        ('\x1b[Cn\x1b[Aq', ['right', 'n', 'up', 'q'], ''),
        ('\x1b[3~\x1b[15~\x1bOP', [], ''),
        ('\x1b[1;5C', ['right'], ''),
        ('s\x1b', ['s'], '\x1b'),
        ('s\x1b[', ['s'], '\x1b['),
        ('\x1b[1;', [], '\x1b[1;'),
        ('\x1bn', ['\x1b', 'n'], ''),
    ],
)
def test_what_a_terminal_sends_is_split_into_keys(text: str, keys: list[str], rest: str) -> None:
    """Otherwise an arrow that is held down would do nothing, and a letter inside a special key would quit or step."""
    assert split_keys(text) == (keys, rest)


@given(st.lists(st.sampled_from(['n', 's', ' ', 'q', '\x1b[A', '\x1b[B', '\x1bOC']), max_size=10), st.data())
def test_where_the_characters_are_cut_makes_no_difference(sent: list[str], data: st.DataObject) -> None:
    """Otherwise a key would get lost whenever a terminal sends slowly."""
    text, rest, found = ''.join(sent), '', []
    cuts = sorted(data.draw(st.lists(st.integers(0, len(text)), max_size=5)))
    for first, last in zip([0, *cuts], [*cuts, len(text)], strict=True):
        keys, rest = split_keys(rest + text[first:last])
        found += keys
    assert (found, rest) == split_keys(text)


@pytest.fixture
def terminal(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """The other end of a terminal that is stdin."""
    ours, theirs = pty.openpty()
    with os.fdopen(theirs, 'r', encoding='utf-8') as stdin:
        monkeypatch.setattr(sys, 'stdin', stdin)
        yield ours
    os.close(ours)


def test_keys_are_handed_over_and_the_terminal_is_as_it_was(terminal: int) -> None:
    """Otherwise a shell would stay without echo after a replay."""
    before, pressed, complete = termios.tcgetattr(sys.stdin), [], threading.Event()

    def take(key: str) -> None:
        pressed.append(key)
        if key == 'q':
            complete.set()

    with Keys(take) as keys:
        assert keys.active
        assert not termios.tcgetattr(sys.stdin)[3] & (termios.ECHO | termios.ICANON)
        os.write(terminal, b'n\x1b[C q')
        assert complete.wait(DEADLINE)
    assert pressed == ['n', 'right', ' ', 'q']
    assert termios.tcgetattr(sys.stdin) == before


@pytest.mark.parametrize('error', [ValueError, KeyboardInterrupt, SystemExit])
def test_an_error_leaves_the_terminal_as_it_was(terminal: int, error: type[BaseException]) -> None:
    """Otherwise a shell would stay without echo after a crash or Ctrl-C."""
    before = termios.tcgetattr(sys.stdin)
    with pytest.raises(error), Keys(lambda _: None):
        raise error
    assert termios.tcgetattr(sys.stdin) == before


def test_a_job_in_the_background_leaves_the_terminal_alone(terminal: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise `replay BAG &` would be stopped by the system before it plays anything."""
    monkeypatch.setattr(os, 'tcgetpgrp', lambda _: os.getpgrp() + 1)
    before = termios.tcgetattr(sys.stdin)
    with Keys(lambda _: None) as keys:
        assert not keys.active
        assert termios.tcgetattr(sys.stdin) == before


def _closed() -> io.StringIO:
    stream = io.StringIO()
    stream.close()
    return stream


@pytest.mark.parametrize('make', [lambda: None, io.StringIO, _closed])
def test_without_a_terminal_nothing_is_read(make: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise a replay under `ros2 launch` or cron, which have no stdin, would fail or eat the input of others."""
    monkeypatch.setattr(sys, 'stdin', make())
    with Keys(lambda _: None) as keys:
        assert not keys.active
