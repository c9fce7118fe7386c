"""What Ctrl-C does, from the first instruction of a process to its last."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

STATUS = 130
"""Exit status of a process that was interrupted: 128 and the number of the signal, as shells have it."""


def end_at_once(*_: Any) -> None:
    """End the process on an interrupt, without a word.

    While modules are imported nothing needs to be tidied up, and a KeyboardInterrupt would be a traceback, or come out
    of a compiled module as an error of another kind.
    """
    os._exit(STATUS)


def install() -> None:
    """Have an interrupt end this process at once, unless it was started to ignore them, as in the background."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, end_at_once)


@contextmanager
def raised() -> Iterator[None]:
    """Have an interrupt raise KeyboardInterrupt within, where it would end the process at once without."""
    yield from _swapped(end_at_once, signal.default_int_handler)


@contextmanager
def ending() -> Iterator[None]:
    """Have an interrupt end the process at once within, for modules that are imported late."""
    yield from _swapped(signal.default_int_handler, end_at_once)


def _swapped(outside: Any, within: Any) -> Iterator[None]:
    if signal.getsignal(signal.SIGINT) is not outside:
        yield
        return
    signal.signal(signal.SIGINT, within)
    try:
        yield
    finally:
        # Unless somebody has seen to it that it does something else.
        if signal.getsignal(signal.SIGINT) is within:
            signal.signal(signal.SIGINT, outside)
