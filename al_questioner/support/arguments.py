"""Command line arguments whose faults are one line, as those of every executable here."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from typing import Any, NoReturn

from al_questioner.domain import InputError

LARGEST_SEED = 2**63 - 1
"""ROS parameters have 64 bits."""

REPEAT_SHOWN_HELP = 'the scripted teacher shows also what is known when other things of the symbol are there'
"""Of several executables."""


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, and to which what begins like a negative number is no option."""

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings)
        # Of argparse itself; it would take -5/40 for an option and complain of a missing value.
        self._negative_number_matcher = re.compile(r'-[\d.]')

    def _print_message(self, message: str, file: Any = None) -> None:
        # That of argparse passes over what could not be printed.
        if file is not None:
            file.write(message)

    def error(self, message: str) -> NoReturn:
        """Raise an InputError instead of printing the usage."""
        raise InputError(f'{message} (--help tells the arguments)')


def number_within(kind: type[int] | type[float], lower: float, upper: float) -> Callable[[str], float]:
    """An argument type: a finite number in a range."""

    def read(text: str) -> float:
        value = kind(text)
        if not lower <= value <= upper:
            raise argparse.ArgumentTypeError(f'must be at least {lower:g} and at most {upper:g}, not {text}')
        return value

    read.__name__ = kind.__name__
    return read
