"""What a parameter of a node is. No ROS is needed to tell of it."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass

from al_questioner.domain import InputError

Value = str | int | float | bool


@dataclass(frozen=True)
class Setting:
    """A parameter that is fixed while the node runs.

    Attributes:
        name: of the parameter.
        default: its value if nobody sets it; also tells the type. An integer given for a float is taken as a float.
        description: one line.
        unit: of a number, empty for a mere count or name.
        lower: smallest number allowed.
        upper: largest number allowed.
        word: if not empty, what can be given in the place of a number; the default is one of the two.
    """

    name: str
    default: Value
    description: str
    unit: str = ''
    lower: float = -math.inf
    upper: float = math.inf
    word: str = ''

    def checked(self, value: object) -> Value:
        """The value in the type of the parameter.

        Raises:
            InputError: another type, not finite, or outside the range.
        """
        if self.word and value == self.word:
            return self.word
        kind = float if self.word else type(self.default)
        if kind is float and type(value) is int:
            value = float(value)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            expected = f"be a number or '{self.word}'" if self.word else f'be of type {kind.__name__}'
            raise InputError(f'parameter {self.name} must {expected}, not {value!r}')
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            if not math.isfinite(value):
                raise InputError(f'parameter {self.name} must be a finite number, not {value}')
            if not self.lower <= value <= self.upper:
                raise InputError(f'parameter {self.name} must {self._range()}, not {value}')
        return value

    @property
    def described(self) -> str:
        """The description, with the unit."""
        return self.description + (f' [{self.unit}]' if self.unit else '')

    def _range(self) -> str:
        if math.isinf(self.upper):
            return f'be {self.lower:g} or more'
        return f'lie in [{self.lower:g}, {self.upper:g}]' + (f' {self.unit}' if self.unit else '')


def help_text(description: str, settings: Sequence[Setting]) -> str:
    """What `--help` of a node prints: what it does, and its parameters with their defaults."""
    width = max(len(setting.name) for setting in settings)
    lines = (f'  {each.name:<{width}}  {each.described} (default {json.dumps(each.default)})' for each in settings)
    return '\n'.join([description, '', 'parameters (--ros-args -p NAME:=VALUE):', *lines])
