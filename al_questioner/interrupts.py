"""What Ctrl-C does, from the first instruction of a process to its last.

This is what a process imports first, so that it needs next to nothing itself.
"""

from __future__ import annotations

import os
import signal

STATUS = 130
"""Exit status of a process that was interrupted: 128 and the number of the signal, as shells have it."""


def end_at_once(*_: object) -> None:
    """End the process on an interrupt, without a word.

    While modules are imported nothing needs to be tidied up, and a KeyboardInterrupt would be a traceback, or come out
    of a compiled module as an error of another kind.
    """
    os._exit(STATUS)


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
    return _Within(end_at_once, signal.default_int_handler)


def ending() -> _Within:
    """Have an interrupt end the process within, for modules that are imported late."""
    return _Within(signal.default_int_handler, end_at_once)


def _exchange(present: object, wanted: object) -> None:
    if signal.getsignal(signal.SIGINT) is present:
        signal.signal(signal.SIGINT, wanted)  # type: ignore[arg-type]
