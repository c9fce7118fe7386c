"""Command line arguments whose faults are one line, as those of every executable here."""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass
from typing import Any, NoReturn

from al_questioner.domain import InputError, Setting

DEFAULT = '%(default)s'
"""Placeholder that argparse replaces by the default of an option."""

JOBS = Setting('jobs', 1, 'local processes', lower=1, upper=1024)


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


@dataclass(frozen=True)
class NumberWithin:
    """An argument type: a finite number in a range."""

    kind: type[int] | type[float]
    lower: float
    upper: float

    def __call__(self, text: str) -> float | str:
        """Return the number that the text stands for."""
        value = self.kind(text)
        if not self.lower <= value <= self.upper:
            raise argparse.ArgumentTypeError(f'must be at least {self.lower:g} and at most {self.upper:g}, not {text}')
        return value

    @property
    def __name__(self) -> str:
        """Name that argparse gives it where a text is no number."""
        return self.kind.__name__


@dataclass(frozen=True)
class NumberOrWord(NumberWithin):
    """An argument type: a finite number in a range, or a word."""

    word: str

    def __call__(self, text: str) -> float | str:
        """Return the number that the text stands for, or the word."""
        if text == self.word:
            return text
        try:
            return super().__call__(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(f'must be a number or {self.word}, not {text}') from error


def add_option(parser: argparse.ArgumentParser, setting: Setting[Any], otherwise: str = DEFAULT, **own: Any) -> None:
    """Add the option of a setting; arguments of `add_argument` prevail.

    The help says what holds otherwise, if the option is not given; without the default in it, the option is None then.
    """
    kind = type(setting.default)
    if kind is bool:
        details: dict[str, Any] = {'action': 'store_true', 'help': setting.described}
    else:
        of_type: Any = NumberWithin(kind, setting.lower, setting.largest) if kind in (int, float) else kind
        details = {
            'type': NumberOrWord(float, setting.lower, setting.largest, setting.word) if setting.word else of_type,
            'choices': setting.choices or None,
            'default': setting.default if DEFAULT in otherwise else None,
            'help': f'{setting.described} ({otherwise})',
        }
    parser.add_argument(f'--{setting.name.replace("_", "-")}', **{**details, **own})
