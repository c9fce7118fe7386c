"""Quality of service that the user sets: parameters `qos_overrides.TOPIC.publisher.POLICY`, or `subscription`."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from rclpy.node import Node
from rclpy.qos import QoSPolicyKind
from rclpy.qos_overriding_options import QoSOverridingOptions

from al_questioner.domain import InputError

PREFIX = 'qos_overrides.'
ENDS = ('publisher', 'subscription')
WORDS: Mapping[str, tuple[str, ...]] = {
    'history': ('keep_last', 'keep_all', 'system_default'),
    'reliability': ('reliable', 'best_effort', 'system_default', 'best_available'),
    'durability': ('transient_local', 'volatile', 'system_default', 'best_available'),
}
"""Allowed values of each policy except `depth`."""
MAXIMAL_DEPTH = 100_000
"""Largest depth, in messages."""


def overriding_options() -> QoSOverridingOptions:
    """Return the options that declare the parameters of one publisher or subscription and apply them."""
    return QoSOverridingOptions([QoSPolicyKind[policy.upper()] for policy in (*WORDS, 'depth')])


def is_override(name: str) -> bool:
    """Return whether a parameter is a quality of service override."""
    return name.startswith(PREFIX)


def given_overrides(node: Node) -> dict[str, object]:
    """Return the overrides that the user gave this node, by the parameter's name."""
    # rclpy shows overrides only in this attribute; it silently drops those that are not declared.
    overrides = node._parameter_overrides
    return {name: overrides[name].value for name in overrides if is_override(name)}


def is_overridden(node: Node, topic: str, policies: Collection[str]) -> bool:
    """Return whether the user chose one of these policies for the subscription to a topic, given by its full name."""
    return any(f'{PREFIX}{topic}.subscription.{policy}' in given_overrides(node) for policy in policies)


def check_overrides(node: Node, topics: Collection[str]) -> None:
    """Reject overrides that would have no effect, before rclpy changes them.

    The topics are all, of this node or of another one that shares its parameter file.

    Raises:
        InputError: an unknown topic, end or policy, or an unusable value.
    """
    known = [node.resolve_topic_name(topic) for topic in topics]
    for name, value in given_overrides(node).items():
        topic, end, policy = ['', '', '', *name.removeprefix(PREFIX).rsplit('.', 2)][-3:]
        if topic not in known:
            raise InputError(f'parameter {name}: no topic {topic!r}; known: {", ".join(known)}')
        if end not in ENDS or policy not in (*WORDS, 'depth'):
            expected = f'{PREFIX}{topic}.{"|".join(ENDS)}.{"|".join((*WORDS, "depth"))}'
            raise InputError(f'unknown parameter {name}; expected {expected}')
        if policy == 'depth':
            if type(value) is not int or not 1 <= value <= MAXIMAL_DEPTH:
                raise InputError(f'parameter {name} must be an integer in [1, {MAXIMAL_DEPTH}], not {value!r}')
        elif value not in WORDS[policy]:
            raise InputError(f'parameter {name} must be one of {", ".join(WORDS[policy])}, not {value!r}')
