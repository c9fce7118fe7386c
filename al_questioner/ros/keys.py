"""Single keys from a terminal, which is as it was afterwards, whatever happens."""

from __future__ import annotations

import os
import select
import sys
import termios
import threading
import tty
from collections.abc import Callable
from types import TracebackType
from typing import Any

ARROWS = {'\x1b[A': 'up', '\x1b[B': 'down', '\x1b[C': 'right', '\x1b[D': 'left'}


class Keys:
    """A context manager that hands over every key pressed; it does nothing where there is no terminal.

    Args:
        pressed: called with a character, or with 'up', 'down', 'left' or 'right', from a thread of its own.
    """

    def __init__(self, pressed: Callable[[str], None]) -> None:
        self._pressed = pressed
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._read, name='keys', daemon=True)
        self._before: Any = None

    def __enter__(self) -> Keys:
        if sys.stdin.isatty():
            self._before = termios.tcgetattr(sys.stdin)
            tty.setcbreak(sys.stdin)
            self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._before is not None:
            self._ended.set()
            self._thread.join(1.0)
            termios.tcsetattr(sys.stdin, termios.TCSADRAIN, self._before)

    def _read(self) -> None:
        while not self._ended.is_set():
            if select.select([sys.stdin], [], [], 0.1)[0]:
                text = os.read(sys.stdin.fileno(), 16).decode(errors='replace')
                if not text:
                    return
                for key in [ARROWS[text]] if text in ARROWS else text:
                    self._pressed(key)
