"""Subscription to every publisher of a topic, whatever quality of service it offers, without duplicate messages."""

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
"""Reliability and durability that every publisher offers."""
LATEST_HEARD = 100
"""Number of latest messages that are remembered to detect duplicates."""
NO_WARNINGS = SubscriptionEventCallbacks(use_default_callbacks=False)
"""Event callbacks without warnings: a publisher that one subscription does not fit is received by another."""


class FlexibleSubscription:
    """Subscriber to a topic with the quality of service that each of its publishers offers.

    A subscription that requests more than a publisher offers receives nothing from it. One that requests less receives
    neither messages that were latched earlier nor repetitions of lost ones. So there is one subscription for each
    offered kind, and a message that arrives by two of them is passed on once. All of this runs on the executor's
    thread.

    Args:
        node: the node that subscribes.
        message_type: type of the topic.
        topic: its name, relative to the node.
        hear: called with every message.
        profile: the highest quality of service to request. If it is volatile, latched messages are not wanted.
        raw: pass on the bytes of a message instead.
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
        # A copy, because rclpy writes the overrides of the parameters into the profile.
        self._profile = copy(profile)
        if topic in qos.SENSED:
            self._profile.reliability, self._profile.durability = LEAST
        self._subscribe(self._profile, qos_overriding_options=overriding_options())

    def look(self) -> None:
        """Subscribe to publishers that are new since the last call, with the quality of service that they offer."""
        if self._is_fixed:
            return
        for one in self._publishers():
            reliability, durability = kind = self._kind_of(one.qos_profile)
            if kind not in {(each.reliability, each.durability) for each in self._profiles}:
                profile = copy(self._profile)
                profile.reliability, profile.durability = reliability, durability
                self._subscribe(profile)

    def unheard(self) -> list[str]:
        """Return the problems with publishers that cannot be received, one line each."""
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
        """Return the part of the wanted quality of service that a publisher offers."""
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
        """Pass a message on, unless another subscription has received the same."""
        identity = information['source_timestamp'], information['publication_sequence_number']
        # The time is 0 if the middleware does not give the time of sending.
        if identity[0]:
            if identity in self._latest:
                return
            self._latest.append(identity)
        self._hear(message)


def unserved(node: Node, topic: str) -> list[str]:
    """Return the nodes that subscribe to a topic of this node but request more than it offers, one line each."""
    own = node.get_fully_qualified_name()
    # The offer as the middleware reports it: an open setting of the profile would count as less than requested.
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
    """Return whether a subscription can receive from a publisher."""
    return bool(qos_check_compatible(offered, asked)[0] != QoSCompatibility.ERROR)


def full_name(one: TopicEndpointInfo) -> str:
    """Return the name of the node at an end of a topic; 'another node' while it is unknown, as for a new node."""
    return 'another node' if 'UNKNOWN' in one.node_name else f'{one.node_namespace.rstrip("/")}/{one.node_name}'
