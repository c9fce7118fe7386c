"""The transport of the nodes under test, and a terminal for the programs under test.

ROS's range LOCALHOST talks to itself by shared memory, in which a process that is killed can leave a lock that hangs
every later node. So the nodes get the range SUBNET, on a transport of Fast DDS that has the loopback interface alone.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path

import hypothesis
import pytest

from al_questioner.cli import main
from al_questioner.support.missing_modules import FOR_BAGS, remedy
from shared.checkout import ROOT

if os.environ.get('RMW_IMPLEMENTATION', 'rmw_fastrtps_cpp') == 'rmw_fastrtps_cpp':
    os.environ['FASTRTPS_DEFAULT_PROFILES_FILE'] = str(Path(__file__).with_name('loopback.xml'))
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'SUBNET'
else:
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'

# Both would fail a test because the machine is busy.
hypothesis.settings.register_profile('patient', deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow])
hypothesis.settings.load_profile('patient')

# So that the processes of tests run this checkout.
os.environ['PYTHONPATH'] = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))

# So that nodes of other runs on this machine are not heard.
os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)

DEADLINE = 90.0
"""Seconds after which a test gives up; far more than anything here takes."""


MISSING_FOR_BAGS = [module for module in FOR_BAGS if find_spec(module) is None]
"""A robot on which rosdep alone installed what the package needs has none of them."""
USES_BAGS = re.compile('shared.bags|BagMessage|BagWriter|RecorderNode|read_bag|read_sessions|--bag|--record')


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out the tests that cannot run without what bags need."""
    source = collection_path / 'conftest.py' if collection_path.is_dir() else collection_path
    if MISSING_FOR_BAGS and source.suffix == '.py' and source.is_file() and source != Path(__file__):
        return bool(USES_BAGS.search(source.read_text(encoding='utf-8'))) or None
    return None


def pytest_report_header() -> str | None:
    """Say what is left out."""
    return f'NOT TESTED is what uses bags: {remedy(MISSING_FOR_BAGS[0])}' if MISSING_FOR_BAGS else None


class PseudoTerminal:
    """A program in a pseudo-terminal, whose screen is kept as a real one would show it."""

    def __init__(self, command: list[str], environment: Mapping[str, str], columns: int = 80, rows: int = 24) -> None:
        import pexpect
        import pyte

        self.screen = pyte.Screen(columns, rows)
        self._stream = pyte.ByteStream(self.screen)
        self.raw = b''
        self.child = pexpect.spawn(command[0], command[1:], env=dict(environment), dimensions=(rows, columns))
        self.child.delaybeforesend = None

    @property
    def text(self) -> str:
        """The text on the screen."""
        return '\n'.join(line.rstrip() for line in self.screen.display)

    def wait_for(self, is_shown: str | Callable[[str], object]) -> str:
        """Wait until the screen shows a text, or what a function of it finds; returns the screen."""
        end = time.monotonic() + DEADLINE
        is_true = is_shown if callable(is_shown) else lambda text: is_shown in text
        while not is_true(self.text):
            assert time.monotonic() < end, f'{is_shown!r} never appeared:\n{self.text}'
            assert self._read(), f'ended before {is_shown!r} appeared:\n{self.text}'
        return self.text

    def press(self, keys: str, until: str | Callable[[str], object] = '') -> str:
        """Type, and wait until the screen shows something; returns the screen."""
        self.child.send(keys)
        return self.wait_for(until) if until else self.text

    def local_modes(self) -> int:
        """Return whether the terminal echoes, edits lines, and so on."""
        import termios

        return int(termios.tcgetattr(self.child.child_fd)[3])

    def status(self) -> int | None:
        """The exit status, once the program has ended."""
        end = time.monotonic() + DEADLINE
        while self._read():
            assert time.monotonic() < end, f'it never ended:\n{self.text}'
        self.child.wait()
        return self.child.exitstatus

    def close(self) -> None:
        """End the program if it has not ended."""
        self.child.close(force=True)

    def _read(self) -> bool:
        """Take in what was written; false once the program has ended."""
        import pexpect

        try:
            content = self.child.read_nonblocking(65536, timeout=0.1)
        except pexpect.TIMEOUT:
            return True
        except pexpect.EOF:
            return False
        self.raw += content
        self._stream.feed(content)
        return True


@pytest.fixture
def refusal(capfd: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """A function that calls an executable, which must end with status 2, and gives the one line that it says."""

    def refused(*command: object) -> str:
        assert main([*map(str, command)]) == 2, command
        (line,) = capfd.readouterr().err.splitlines()
        return line

    return refused


@pytest.fixture
def open_terminal() -> Iterator[Callable[..., PseudoTerminal]]:
    """Runs commands in pseudo-terminals, all of which are gone after the test."""
    for module in ('pexpect', 'pyte'):
        pytest.importorskip(module)
    opened: list[PseudoTerminal] = []

    def open_one(command: list[str], **options: object) -> PseudoTerminal:
        environment = {**os.environ, 'TERM': 'xterm-256color', 'LANG': 'C.UTF-8', **options.pop('environment', {})}
        environment = {name: value for name, value in environment.items() if value is not None}
        opened.append(PseudoTerminal(command, environment, **options))
        return opened[-1]

    try:
        yield open_one
    finally:
        for terminal in opened:
            terminal.close()
