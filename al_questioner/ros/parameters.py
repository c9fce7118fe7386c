"""Node parameters: declared with description, unit and range, checked once, read as a mapping."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, ParameterType
from rclpy.node import Node
from rclpy.parameter import Parameter

from al_questioner.domain import InputError
from al_questioner.ros.overrides import is_override

Value = str | int | float | bool

_TYPES = {
    bool: ParameterType.PARAMETER_BOOL,
    int: ParameterType.PARAMETER_INTEGER,
    float: ParameterType.PARAMETER_DOUBLE,
    str: ParameterType.PARAMETER_STRING,
}
_LARGEST_INTEGER = 2**63 - 1


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
    """

    name: str
    default: Value
    description: str
    unit: str = ''
    lower: float = -math.inf
    upper: float = math.inf

    def checked(self, value: object) -> Value:
        """The value in the type of the parameter.

        Raises:
            InputError: another type, not finite, or outside the range.
        """
        kind = type(self.default)
        if kind is float and type(value) is int:
            value = float(value)
        if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
            raise InputError(f'parameter {self.name} must be of type {kind.__name__}, not {value!r}')
        if isinstance(value, (int, float)) and not isinstance(value, bool):
            if not math.isfinite(value):
                raise InputError(f'parameter {self.name} must be a finite number, not {value}')
            if not self.lower <= value <= self.upper:
                raise InputError(f'parameter {self.name} must {self._range()}, not {value}')
        return value

    def _range(self) -> str:
        if math.isinf(self.upper):
            return f'be {self.lower:g} or more'
        return f'lie in [{self.lower:g}, {self.upper:g}]' + (f' {self.unit}' if self.unit else '')

    def descriptor(self) -> ParameterDescriptor:
        """What `ros2 param describe` shows."""
        unit = f' [{self.unit}]' if self.unit else ''
        descriptor = ParameterDescriptor(
            name=self.name, type=_TYPES[type(self.default)], description=self.description + unit, read_only=True
        )
        bounded = math.isfinite(self.lower) or math.isfinite(self.upper)
        if type(self.default) is float and bounded:
            descriptor.floating_point_range = [FloatingPointRange(from_value=self.lower, to_value=self.upper)]
        if type(self.default) is int and bounded:
            lower = int(self.lower) if math.isfinite(self.lower) else -_LARGEST_INTEGER
            upper = int(self.upper) if math.isfinite(self.upper) else _LARGEST_INTEGER
            descriptor.integer_range = [IntegerRange(from_value=lower, to_value=upper, step=1)]
        return descriptor


def refuse_unknown(node: Node, known_elsewhere: Collection[str]) -> None:
    """Refuse parameters that were set but that no node has: most likely misspelt.

    Args:
        node: that has declared all of its parameters.
        known_elsewhere: parameters of the other nodes, which a common file may set.

    Raises:
        InputError: there is one; the text lists the known ones.
    """
    known = {name for name in node.get_parameters_by_prefix('') if not is_override(name)}
    # rclpy tells of overrides only through this attribute; it drops those that are not declared in silence.
    for name in node._parameter_overrides:
        if name not in known and name not in known_elsewhere and not is_override(name):
            raise InputError(f'unknown parameter {name}; known: {", ".join(sorted(known))}')


def help_text(description: str | None, settings: Sequence[Setting]) -> str:
    """What `--help` of a node prints: what it does, and its parameters with their defaults."""
    lines = [(description or '').strip(), '', 'parameters (--ros-args -p NAME:=VALUE):']
    width = max(len(setting.name) for setting in settings)
    for setting in settings:
        default = json.dumps(setting.default)
        lines.append(f'  {setting.name:<{width}}  {setting.descriptor().description} (default {default})')
    return '\n'.join(lines)


def declare(node: Node, settings: Sequence[Setting]) -> dict[str, Value]:
    """Declare parameters on a node and return their values by name.

    Raises:
        InputError: a value of the wrong type or outside its range.
    """
    values = {}
    for setting in settings:
        given = node.declare_parameter(setting.name, setting.default, ParameterDescriptor(dynamic_typing=True))
        values[setting.name] = setting.checked(given.value)
        node.set_parameters([Parameter(setting.name, value=values[setting.name])])
        node.set_descriptor(setting.name, setting.descriptor())
    return values
