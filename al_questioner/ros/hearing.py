"""Hearing every publisher of a topic, whatever quality of service it offers, and each message once."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from copy import copy
from typing import Any

from rclpy.event_handler import SubscriptionEventCallbacks
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSCompatibility, QoSProfile, ReliabilityPolicy, qos_check_compatible
from rclpy.topic_endpoint_info import TopicEndpointInfo

from al_questioner.ros import qos
from al_questioner.ros.overrides import is_overridden, overriding_options

Kind = tuple[ReliabilityPolicy, DurabilityPolicy]

LEAST: Kind = (ReliabilityPolicy.BEST_EFFORT, DurabilityPolicy.VOLATILE)
"""What every publisher offers."""
LATEST_HEARD = 100
"""Messages that are known again when they come a second time."""
NO_WARNINGS = SubscriptionEventCallbacks(use_default_callbacks=False)
"""A publisher that one subscription does not suit is heard by another."""


class Hearing:
    """Subscribes to a topic as each of its publishers offers.

    A subscription that asks for more than a publisher offers hears nothing of it. One that asks for less is given
    neither what was latched before it came, nor again what was lost. So there is one of each kind that is offered; of
    what comes by two of them the second is left out. All of it happens on the executor's thread.

    Args:
        node: that listens.
        message_type: of the topic.
        topic: its name, relative to the node.
        hear: called with every message.
        profile: to ask for at most. If it is volatile, nobody's latched message is wanted.
        raw: hand over the bytes of a message instead.
    """

    def __init__(
        self,
        node: Node,
        message_type: type,
        topic: str,
        hear: Callable[[Any], None],
        profile: QoSProfile,
        raw: bool = False,
    ) -> None:
        self._node = node
        self._type = message_type
        self._topic = topic
        self._name = node.resolve_topic_name(topic)
        self._hear = hear
        self._raw = raw
        self._wants_latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        self._is_fixed = is_overridden(node, self._name, ('reliability', 'durability'))
        self._latest: deque[tuple[int, int]] = deque(maxlen=LATEST_HEARD)
        self._profiles: list[QoSProfile] = []
        # What rclpy makes of the parameters is written into the profile.
        self._profile = copy(profile)
        if topic in qos.SENSED:
            self._profile.reliability, self._profile.durability = LEAST
        self._subscribe(self._profile, qos_overriding_options=overriding_options())

    def look(self) -> None:
        """Subscribe as those publishers offer that have come since the last time."""
        if self._is_fixed:
            return
        for one in self._publishers():
            reliability, durability = kind = self._kind_of(one.qos_profile)
            if kind not in {(each.reliability, each.durability) for each in self._profiles}:
                profile = copy(self._profile)
                profile.reliability, profile.durability = reliability, durability
                self._subscribe(profile)

    def unheard(self) -> list[str]:
        """What is wrong with publishers that cannot be heard, a line each."""
        lines = []
        expected = f'{self._type.__module__.split(".")[0]}/msg/{self._type.__name__}'
        for one in self._publishers():
            if one.topic_type != expected:
                lines.append(f'{full_name(one)} publishes {one.topic_type} on {self._name}, not {expected}: unheard')
            elif self._is_fixed and not any(fits(one.qos_profile, profile) for profile in self._profiles):
                lines.append(f'{full_name(one)} offers less on {self._name} than qos_overrides ask for: unheard')
        return lines

    def _publishers(self) -> list[TopicEndpointInfo]:
        found: list[TopicEndpointInfo] = self._node.get_publishers_info_by_topic(self._name)
        return found

    def _kind_of(self, offered: QoSProfile) -> Kind:
        """The most that a publisher offers of what is wanted."""
        if offered.reliability != ReliabilityPolicy.RELIABLE:
            return LEAST
        latched = self._wants_latched and offered.durability == DurabilityPolicy.TRANSIENT_LOCAL
        return offered.reliability, DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE

    def _subscribe(self, profile: QoSProfile, **options: Any) -> None:
        take: Callable[..., None] = self._take
        self._node.create_subscription(
            self._type, self._topic, take, profile, raw=self._raw, event_callbacks=NO_WARNINGS, **options
        )
        self._profiles.append(profile)

    def _take(self, message: Any, information: dict[str, Any]) -> None:
        """Hand a message on, unless another subscription has heard the same."""
        identity = information['source_timestamp'], information['publication_sequence_number']
        # A middleware that does not tell the time of sending says 0.
        if identity[0]:
            if identity in self._latest:
                return
            self._latest.append(identity)
        self._hear(message)


def unserved(node: Node, topic: str) -> list[str]:
    """Who listens to a topic of this node and hears nothing, as they ask for more than it offers, a line each."""
    own = node.get_fully_qualified_name()
    # As the middleware has it: what a profile leaves open would pass for less than what is asked for.
    offers = [one.qos_profile for one in node.get_publishers_info_by_topic(topic) if full_name(one) == own]
    served, reasons = set(), {}
    for one in node.get_subscriptions_info_by_topic(topic) if offers else ():
        if fits(offers[0], one.qos_profile):
            served.add(full_name(one))
        else:
            reason = qos_check_compatible(offers[0], one.qos_profile)[1]
            reasons[full_name(one)] = reason.replace('ERROR: ', '').rstrip(';').lower()
    return [
        f'{name} listens to {topic} and hears nothing: {reason}'
        for name, reason in reasons.items()
        if name not in served
    ]


def fits(offered: QoSProfile, asked: QoSProfile) -> bool:
    """Whether a subscription hears a publisher."""
    return bool(qos_check_compatible(offered, asked)[0] != QoSCompatibility.ERROR)


def full_name(one: TopicEndpointInfo) -> str:
    """The node at an end of a topic; 'another node' as long as it is not known, which one that has just come is not."""
    return 'another node' if 'UNKNOWN' in one.node_name else f'{one.node_namespace.rstrip("/")}/{one.node_name}'
