"""Node parameters: declared as their settings say, read as a mapping."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor, ParameterType
from rclpy.node import Node
from rclpy.parameter import Parameter

from al_questioner.domain import InputError
from al_questioner.ros.overrides import is_override
from al_questioner.ros.setting import Setting, Value

_TYPES = {
    bool: ParameterType.PARAMETER_BOOL,
    int: ParameterType.PARAMETER_INTEGER,
    float: ParameterType.PARAMETER_DOUBLE,
    str: ParameterType.PARAMETER_STRING,
}
_LARGEST_INTEGER = 2**63 - 1


def descriptor(setting: Setting) -> ParameterDescriptor:
    """What `ros2 param describe` shows."""
    kind = type(setting.default)
    described = ParameterDescriptor(
        name=setting.name,
        type=ParameterType.PARAMETER_NOT_SET if setting.word else _TYPES[kind],
        description=setting.described,
        read_only=True,
        dynamic_typing=bool(setting.word),
    )
    bounded = math.isfinite(setting.lower) or math.isfinite(setting.upper)
    if kind is float and bounded:
        described.floating_point_range = [FloatingPointRange(from_value=setting.lower, to_value=setting.upper)]
    if kind is int and bounded:
        lower = int(setting.lower) if math.isfinite(setting.lower) else -_LARGEST_INTEGER
        upper = int(setting.upper) if math.isfinite(setting.upper) else _LARGEST_INTEGER
        described.integer_range = [IntegerRange(from_value=lower, to_value=upper, step=1)]
    return described


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
        node.set_descriptor(setting.name, descriptor(setting))
    return values
