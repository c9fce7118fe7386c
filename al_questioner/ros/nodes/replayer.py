"""The node that plays a bag."""

from __future__ import annotations

import posixpath
import time
from collections.abc import Sequence
from typing import Any

from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock

from al_questioner.bags import Bag, BagMessage
from al_questioner.bags.playback import Playback, begins_turn
from al_questioner.domain import InputError
from al_questioner.protocol.effects import AwaitArrival, Effect, Publish
from al_questioner.protocol.replayer import CLOCK, KEY, ReplayMachine, Rival, Surroundings
from al_questioner.ros import qos
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.message_classes import message_class
from al_questioner.ros.types import header

SHARED = frozenset((CLOCK, '/diagnostics', '/parameter_events', '/rosout', '/tf', '/tf_static'))
"""Topics that all robots share: they lie in nobody's namespace."""


class ReplayNode(MachineNode):
    """Runs a `ReplayMachine`; what it publishes is the recorded bytes.

    Args:
        bag: what is played.
        playback: when.
        patience: seconds for which it waits for a first listener.
        clock_hz: how often the recorded time is published on /clock; 0 for not at all.
        node_arguments: of the node.

    Raises:
        InputError: a message type of the bag that is not installed.
    """

    machine: ReplayMachine

    def __init__(self, bag: Bag, playback: Playback, patience: float, clock_hz: float, **node_arguments: Any) -> None:
        topics = [topic for topic in bag.topics if not (clock_hz > 0 and topic.name == CLOCK)]
        namespace = common_namespace([topic.name for topic in topics])
        classes = {topic: message_class(topic.type) for topic in topics}
        names = [published_name(topic.name, namespace) for topic in topics]
        super().__init__('replay', [*names, '/diagnostics'], **{'namespace': namespace.strip('/'), **node_arguments})
        self.playback = playback
        self._out: dict[tuple[str, str], Publisher] = {}
        for topic, class_ in classes.items():
            profile = qos.LATCHED if topic.latched else qos.EVENTS
            name = published_name(topic.name, namespace)
            self._out[topic.name, topic.type] = self.advertise(class_, name, profile)
        self._turns = {(message.topic, message.type) for message in bag.messages if begins_turn(message)}
        self._told_time = self.create_publisher(Clock, CLOCK, 10) if clock_hz > 0 else None
        surroundings = Surroundings(self._count_listeners, self._find_rival)
        self.run(ReplayMachine(playback, surroundings, patience, 1 / clock_hz if clock_hz > 0 else None))

    @property
    def started(self) -> bool:
        """See `ReplayMachine`."""
        return self.machine.started

    @property
    def over(self) -> bool:
        """See `ReplayMachine`."""
        return self.machine.over

    @property
    def failure(self) -> InputError | None:
        """See `ReplayMachine`."""
        return self.machine.failure

    def press(self, key: str) -> None:
        """Do what a key stands for; for an unknown one, nothing."""
        self.enter(KEY, key)

    def perform(self, effect: Effect) -> None:
        """See `MachineNode.perform`."""
        if isinstance(effect, Publish):
            self._play(effect.content)
        elif isinstance(effect, AwaitArrival):
            end = time.monotonic() + effect.seconds
            for out in self._out.values():
                out.wait_for_all_acked(Duration(seconds=max(0.0, end - time.monotonic())))
        else:
            super().perform(effect)

    def _play(self, content: BagMessage | int) -> None:
        """Publish a recorded message, or the recorded time in nanoseconds."""
        if isinstance(content, BagMessage):
            out = self._out.get((content.topic, content.type))
            if out is not None:
                out.publish(content.data)
        elif self._told_time is not None:
            self._told_time.publish(Clock(clock=header(content, '').stamp))

    def _count_listeners(self) -> int:
        return sum(out.get_subscription_count() for out in self._out.values())

    def _find_rival(self) -> Rival | None:
        for topic in (out.topic_name for key, out in self._out.items() if key in self._turns):
            others = self.other_publishers(topic)
            if others:
                return Rival(others[0], topic)
        return None


def common_namespace(topics: Sequence[str]) -> str:
    """Return the namespace that all of these names lie in, without a slash at its end; empty if there is none.

    >>> common_namespace(['/robot/turn', '/robot/camera/image', '/diagnostics'])
    '/robot'
    """
    spaces = [posixpath.dirname(topic) for topic in topics if topic not in SHARED]
    return posixpath.commonpath(spaces).rstrip('/') if spaces else ''


def published_name(topic: str, namespace: str) -> str:
    """Return a recorded name relative to the namespace of the recording, unless it is one that all robots share.

    >>> published_name('/robot/turn', '/robot')
    'turn'
    """
    return topic if topic in SHARED else topic.removeprefix(namespace).lstrip('/')
