"""Handling of Ctrl-C, from the first instruction of a process to its last.

A process imports this module first, so this module imports almost nothing.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator
from types import FrameType

STATUS = 130
"""Exit status of an interrupted process: 128 plus the number of the signal, as in shells."""

DEAF = ('importlib', 'numba', 'llvmlite')
"""Packages that do not pass a KeyboardInterrupt on: it is lost, or arrives as another error."""

SHOW_CURSOR = b'\x1b[?25h'


def end_at_once(*_: object) -> None:
    """End the process on an interrupt, without a message; while it starts, there is nothing to clean up."""
    if os.isatty(1):
        os.write(1, SHOW_CURSOR)
    os._exit(STATUS)


def raise_or_end(_: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, or end the process while modules are imported or functions compiled."""
    while frame is not None:
        if frame.f_globals.get('__name__', '').partition('.')[0] in DEAF:
            end_at_once()
        frame = frame.f_back
    raise KeyboardInterrupt


def install() -> None:
    """Make an interrupt end this process at once, unless it was started to ignore interrupts, as in the background."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, end_at_once)


@contextlib.contextmanager
def raised() -> Iterator[None]:
    """Make an interrupt raise KeyboardInterrupt in this context, where otherwise it would end the process.

    Where other code has set a handler, that one stays.
    """
    _exchange(end_at_once, raise_or_end)
    try:
        yield
    finally:
        _exchange(raise_or_end, end_at_once)


@contextlib.contextmanager
def blocked() -> Iterator[None]:
    """Delay interrupts until this context ends; processes that are started in it never receive one.

    This process must end them. Otherwise they would print how they were interrupted.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _exchange(present: object, wanted: object) -> None:
    if signal.getsignal(signal.SIGINT) is present and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, wanted)  # type: ignore[arg-type]
