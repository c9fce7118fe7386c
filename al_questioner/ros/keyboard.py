"""Reader of single keys from a terminal, which always restores the terminal's settings."""

from __future__ import annotations

import os
import re
import select
import sys
import termios
import threading
import tty
from collections.abc import Callable
from typing import Any

ARROWS = {'A': 'up', 'B': 'down', 'C': 'right', 'D': 'left'}
"""Name of each arrow key, by the last letter of its escape sequence."""
KEY = re.compile(
    r'\x1b(?:\[|O)[0-9;]*(?P<last>[A-Za-z~])|(?P<begun>\x1b(?:(?:\[|O)[0-9;]*)?\Z)|(?P<plain>.)', re.DOTALL
)
"""Pattern for a special key, an incomplete special key at the end of the input, or a character."""


class Keys:
    """Context manager that passes on every key pressed; without a terminal it does nothing.

    Args:
        pressed: called with a character, or with 'up', 'down', 'left' or 'right', from a thread of its own.

    Attributes:
        active: whether keys are read.
    """

    def __init__(self, pressed: Callable[[str], None]) -> None:
        self.active = False
        self._pressed = pressed
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._read, name='keys', daemon=True)
        self._before: Any = None

    def __enter__(self) -> Keys:
        if _is_ours():
            self._before = termios.tcgetattr(sys.stdin)
            self.active = True
            try:
                tty.setcbreak(sys.stdin)
                self._thread.start()
            except BaseException:
                self._restore()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        if self.active:
            try:
                self._ended.set()
                self._thread.join(1.0)
            finally:
                self._restore()

    def _restore(self) -> None:
        self.active = False
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._before)

    def _read(self) -> None:
        rest = ''
        while not self._ended.is_set():
            if not select.select([sys.stdin], [], [], 0.1)[0]:
                continue
            try:
                content = os.read(sys.stdin.fileno(), 64)
            except OSError:
                return
            if not content:
                return
            keys, rest = split_keys(rest + content.decode(errors='replace'))
            for key in keys:
                self._pressed(key)


def split_keys(text: str) -> tuple[list[str], str]:
    """Return the keys that a terminal's characters stand for, and an incomplete key at their end.

    Special keys other than arrows are left out, so that no letter in them is taken for a key.
    """
    found, rest = [], ''
    for match in KEY.finditer(text):
        if match['begun']:
            rest = match['begun']
        elif match['plain']:
            found.append(match['plain'])
        elif match['last'] in ARROWS:
            found.append(ARROWS[match['last']])
    return found, rest


def _is_ours() -> bool:
    """Return whether stdin is a terminal that this process may read; a background process would be stopped."""
    try:
        if not sys.stdin.isatty():
            return False
    except (AttributeError, ValueError):
        # There is no stdin, or it is closed.
        return False
    try:
        return os.tcgetpgrp(sys.stdin.fileno()) == os.getpgrp()
    except OSError:
        # It is not the terminal of this session, so reading it stops nothing.
        return True
