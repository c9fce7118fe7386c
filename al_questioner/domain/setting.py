"""Declaration of a setting: the one source of a parameter, an option, a member of a document and a launch argument."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Generic, TypeVar

from al_questioner.domain.errors import SettingsError

Value = TypeVar('Value')

LARGEST_AMOUNT = 1e12
"""Largest number with a fraction, such as a budget or a price: far beyond, a price of 1 would be lost in rounding."""
LARGEST_INTEGER = 2**63 - 1
"""Largest integer of 64 bits, which ROS parameters have."""


@dataclass(frozen=True)
class Setting(Generic[Value]):
    """Value that can be set before a node or a command starts.

    Attributes:
        default: its value if nobody sets it; also tells the type. An integer given for a float is taken as a float.
        description: one line.
        unit: of a number, empty for a mere count or name.
        word: if not empty, what can be given in the place of a number; the default is one of the two.
        choices: all texts that can be given; empty: any.
    """

    name: str
    default: Value
    description: str
    unit: str = ''
    lower: float = -math.inf
    upper: float = math.inf
    word: str = ''
    choices: tuple[str, ...] = ()

    @property
    def described(self) -> str:
        """The description, with the unit."""
        return self.description + (f' [{self.unit}]' if self.unit else '')

    @property
    def explained(self) -> str:
        """The description, with the unit and the range."""
        numbers = ', '.join(filter(None, (self.unit, self.limits)))
        return self.description + (f' [{numbers}]' if numbers else '')

    @property
    def limits(self) -> str:
        """The range in words; empty if there is none."""
        if math.isinf(self.lower):
            return ''
        return f'{self.lower:g} or more' if math.isinf(self.upper) else f'{self.lower:g} to {self.upper:g}'

    @property
    def largest(self) -> float:
        """Largest number that is taken, also where no largest one is declared."""
        return min(self.upper, LARGEST_INTEGER if type(self.default) is int else LARGEST_AMOUNT)

    def check(self, value: float, subject: str = '') -> None:
        """Refuse a number outside the range; the text calls it by the subject, or by the name if none is given.

        Raises:
            SettingsError: it is not finite, or outside the range.
        """
        what = subject or self.name
        if not math.isfinite(value):
            raise SettingsError(f'{what} must be a finite number, not {value}')
        if value < self.lower and math.isinf(self.upper):
            raise SettingsError(f'{what} must be {self.lower:g} or more, not {value}')
        if not self.lower <= value <= self.largest:
            unit = f' {self.unit}' if self.unit and math.isfinite(self.upper) else ''
            raise SettingsError(f'{what} must lie in [{self.lower:g}, {self.largest:g}]{unit}, not {value}')
