"""What Ctrl-C does, from the first instruction of a process to its last.

This is what a process imports first, so that it needs next to nothing itself.
"""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Iterator
from types import FrameType

STATUS = 130
"""Exit status of a process that was interrupted: 128 and the number of the signal, as shells have it."""

DEAF = ('importlib', 'numba', 'llvmlite')
"""Packages through which a KeyboardInterrupt does not come: it is lost, or arrives as an error of another kind."""

SHOW_CURSOR = b'\x1b[?25h'


def end_at_once(*_: object) -> None:
    """End the process on an interrupt, without a word: while it starts there is nothing to be tidied up."""
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
    """Have an interrupt end this process at once, unless it was started to ignore them, as in the background."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, end_at_once)


class _Within:
    """A context manager in which an interrupt is handled in another way, unless somebody else handles them."""

    def __init__(self, outside: object, within: object) -> None:
        self._outside, self._within = outside, within

    def __enter__(self) -> None:
        _exchange(self._outside, self._within)

    def __exit__(self, *_: object) -> None:
        _exchange(self._within, self._outside)


def raised() -> _Within:
    """Have an interrupt raise KeyboardInterrupt within, where it would end the process without."""
    return _Within(end_at_once, raise_or_end)


@contextlib.contextmanager
def blocked() -> Iterator[None]:
    """Have an interrupt wait until this is over; processes that are started within never hear of one.

    It is for this process to end them. They would print how they were interrupted.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _exchange(present: object, wanted: object) -> None:
    if signal.getsignal(signal.SIGINT) is present and threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, wanted)  # type: ignore[arg-type]
