"""Plays the beginning of an episode at a pseudo-terminal, and keeps what it shows as a picture and as text.

    python docs/examples/terminal_screenshot.py docs/figures/terminal

writes docs/figures/terminal.svg, and docs/figures/terminal.txt from a terminal without colours. It needs pexpect and
pyte (`pip install '.[dev]'`).
"""

from __future__ import annotations

import io
import os
import re
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path

import pexpect
import pyte
from rich.console import Console
from rich.style import Style
from rich.text import Text

COLUMNS, ROWS = 80, 24
DEADLINE = 60
WORLD = ['-p', 'task:=kitchen_table', '-p', 'seed:=2']
EPISODE = ['-p', 'strategy:=random_fsq', '-p', 'budget:=12.0', '-p', 'turns:=12']
ENVIRONMENT = {**os.environ, 'TERM': 'xterm-256color', 'LANG': 'C.UTF-8'}
ANSWERS = ('12\r', 'f', 'n', 'b')
"""Keys: colour and size, a fruit, none of these, a beverage; the fifth question is the one that is shown."""


def command(name: str, namespace: str, *parameters: str) -> list[str]:
    """The command line of a node."""
    return [sys.executable, '-m', 'al_questioner', name, '--ros-args', '-r', f'__ns:=/{namespace}', *parameters]


def wait_for(child: pexpect.spawn, stream: pyte.ByteStream, is_shown: Callable[[], object]) -> None:
    """Read until something is shown, and nothing more is written to the screen."""
    end = time.monotonic() + DEADLINE
    while time.monotonic() < end:
        try:
            stream.feed(child.read_nonblocking(65536, timeout=0.5))
        except pexpect.TIMEOUT:
            if is_shown():
                return
    raise SystemExit('the question never came')


def session(environment: Mapping[str, str]) -> pyte.Screen:
    """Answer until the question is asked that is wanted; returns the screen that shows it."""
    screen = pyte.Screen(COLUMNS, ROWS)
    namespace = f'screenshot_{uuid.uuid4().hex[:8]}'
    robot = [
        subprocess.Popen(command(name, namespace, *WORLD, *more), stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for name, more in (('perception', ()), ('learner', EPISODE))
    ]
    program, *arguments = command('teacher', namespace, '-p', 'mode:=terminal', '-p', 'teacher_id:=anna')
    child = pexpect.spawn(program, arguments, env={**ENVIRONMENT, **environment}, dimensions=(ROWS, COLUMNS))
    stream = pyte.ByteStream(screen)

    def is_asked(turn: int) -> bool:
        text = '\n'.join(screen.display)
        # The picture pushes the map to the right, and is the last thing to come.
        return f'turn {turn} of' in text and 'q quit' in text and bool(re.search(r'^[^┌].*┌─', text, re.MULTILINE))

    try:
        for turn, keys in enumerate(ANSWERS, start=1):
            wait_for(child, stream, lambda turn=turn: is_asked(turn))
            child.send(keys)
        wait_for(child, stream, lambda: is_asked(len(ANSWERS) + 1))
    finally:
        child.send('q')
        child.close()
        for process in robot:
            process.terminate()
            process.wait()
    return screen


def picture(screen: pyte.Screen) -> str:
    """The screen as SVG, by rich."""
    console = Console(width=COLUMNS, file=io.StringIO(), record=True, force_terminal=True, color_system='truecolor')
    for row in range(ROWS):
        line = Text()
        for column in range(COLUMNS):
            cell = screen.buffer[row][column]
            style = Style(color=color(cell.fg), bgcolor=color(cell.bg), bold=cell.bold, reverse=cell.reverse)
            line.append(cell.data, style)
        console.print(line, end='\n', soft_wrap=True)
    return console.export_svg(title='ros2 run al_questioner teacher --ros-args -p mode:=terminal', unique_id='terminal')


def color(name: str) -> str | None:
    """A colour of pyte as one of rich."""
    if name == 'default':
        return None
    return f'#{name}' if re.fullmatch('[0-9a-f]{6}', name) else name.replace('brown', 'yellow')


def main() -> None:
    """Write both files."""
    out = Path(sys.argv[1])
    out.with_suffix('.svg').write_text(picture(session({'COLORTERM': 'truecolor'})), encoding='utf-8')
    lines = '\n'.join(line.rstrip() for line in session({'NO_COLOR': '1'}).display)
    out.with_suffix('.txt').write_text(f'{lines.rstrip()}\n', encoding='utf-8')


if __name__ == '__main__':
    main()
