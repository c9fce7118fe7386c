"""Node parameters: declared as their settings say, read as a mapping."""

from __future__ import annotations

import math
from collections.abc import Collection
from typing import Any

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, ParameterType
from rclpy.node import Node
from rclpy.parameter import Parameter

from al_questioner.domain import InputError, Setting
from al_questioner.ros.overrides import is_override
from al_questioner.ros.settings import Settings

Value = str | int | float | bool

REMOVED = {
    'tune_every': 'amplitude and length scale stay as configured, or as they were last in a session that was tuned'
}
"""Parameters of earlier versions, and what holds now; a file may still set such a parameter to 0, which was `never`."""

_TYPES = {
    bool: ParameterType.PARAMETER_BOOL,
    int: ParameterType.PARAMETER_INTEGER,
    float: ParameterType.PARAMETER_DOUBLE,
    str: ParameterType.PARAMETER_STRING,
}


def checked(setting: Setting[Any], value: object) -> Value:
    """Return a value in the type of its parameter.

    Raises:
        InputError: another type, not finite, outside the range, or none of the choices.
    """
    if setting.word and value == setting.word:
        return setting.word
    kind = float if setting.word else type(setting.default)
    if kind is float and type(value) is int:
        value = float(value)
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        expected = f"be a number or '{setting.word}'" if setting.word else f'be of type {kind.__name__}'
        raise InputError(f'parameter {setting.name} must {expected}, not {value!r}')
    if setting.choices and value not in setting.choices:
        known = ', '.join(setting.choices)
        raise InputError(f'parameter {setting.name}: unknown {setting.name} {value!r}; known: {known}')
    if kind in (int, float):
        setting.check(value, f'parameter {setting.name}')
    return value


def descriptor(setting: Setting[Any]) -> ParameterDescriptor:
    """Make the descriptor that `ros2 param describe` shows."""
    kind = type(setting.default)
    described = ParameterDescriptor(
        name=setting.name,
        type=ParameterType.PARAMETER_NOT_SET if setting.word else _TYPES[kind],
        description=setting.described,
        read_only=True,
        dynamic_typing=bool(setting.word),
    )
    # A range would be one of the word, too.
    if math.isfinite(setting.lower) and not setting.word:
        if kind is float:
            limits = FloatingPointRange(from_value=float(setting.lower), to_value=float(setting.upper))
            described.floating_point_range = [limits]
        if kind is int:
            whole = IntegerRange(from_value=int(setting.lower), to_value=int(setting.largest), step=1)
            described.integer_range = [whole]
    return described


def reject_unknown(node: Node, known_elsewhere: Collection[str]) -> None:
    """Refuse parameters that were set but that no node has: most likely misspelt.

    What is known elsewhere are parameters of the other nodes, which a common file may set.

    Raises:
        InputError: there is one; the text lists the known ones.
    """
    known = {name for name in node.get_parameters_by_prefix('') if not is_override(name)}
    # rclpy tells of overrides only through this attribute; it drops those that are not declared in silence.
    for name, given in node._parameter_overrides.items():
        if name in REMOVED:
            if given.value != 0:
                raise InputError(f'parameter {name} was removed: {REMOVED[name]}; leave it out')
        elif name not in known and name not in known_elsewhere and not is_override(name):
            raise InputError(f'unknown parameter {name}; known: {", ".join(sorted(known))}')


def declare(node: Node, settings: Settings) -> dict[str, Value]:
    """Declare parameters on a node and return their values by name.

    Raises:
        InputError: a value of the wrong type or outside its range.
    """
    values = {}
    for setting in settings:
        given = node.declare_parameter(setting.name, setting.default, ParameterDescriptor(dynamic_typing=True))
        values[setting.name] = checked(setting, given.value)
        node.set_parameters([Parameter(setting.name, value=values[setting.name])])
        node.set_descriptor(setting.name, descriptor(setting))
    return values
