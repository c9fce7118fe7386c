"""The node that plays a bag."""

from __future__ import annotations

import posixpath
import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from rclpy.clock import Clock as NodeClock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock

from al_questioner.bags import Bag, BagMessage
from al_questioner.bags.playback import FASTER, Playback, begins_turn
from al_questioner.domain import InputError
from al_questioner.ros import qos
from al_questioner.ros.message_classes import message_class
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.types import header

LONGEST_WAIT = 0.5
"""Seconds after which it looks again, however far away the next message is."""
POLL = 0.1
"""Seconds between two looks for listeners."""
SETTLED = 1.0
"""Seconds without a new listener after which all are taken to be there."""
LINGER = 2.0
"""Seconds for which listeners may be behind at the end."""
SHARED = frozenset(('/clock', '/diagnostics', '/parameter_events', '/rosout', '/tf', '/tf_static'))
"""Topics that all robots share: they lie in nobody's namespace."""


class ReplayNode(QuestionerNode):
    """Publishes the messages of a bag, as they were recorded, when the playback says so.

    Everything is done by the worker; what it publishes is the recorded bytes.

    Args:
        bag: what is played.
        playback: when.
        patience: seconds for which it waits for a first listener.
        clock_hz: how often the recorded time is published on /clock; 0 for not at all.

    Attributes:
        started: whether it waits for listeners no longer.
        over: whether there is no more to do: it was told to quit, or all is played and has arrived, or it failed.
        failure: why it must not go on.

    Raises:
        InputError: a message type of the bag that is not installed.
    """

    def __init__(self, bag: Bag, playback: Playback, patience: float, clock_hz: float, **node_arguments: Any) -> None:
        topics = [topic for topic in bag.topics if not (clock_hz > 0 and topic.name == '/clock')]
        namespace = common_namespace([topic.name for topic in topics])
        classes = {topic: message_class(topic.type) for topic in topics}
        names = [published_name(topic.name, namespace) for topic in topics]
        super().__init__('replay', [*names, '/diagnostics'], **{'namespace': namespace.strip('/'), **node_arguments})
        self.playback = playback
        self.started = False
        self.over = False
        self.failure: InputError | None = None
        self._round = 0
        self._out: dict[tuple[str, str], Publisher] = {}
        for topic, class_ in classes.items():
            profile = qos.LATCHED if topic.latched else qos.EVENTS
            name = published_name(topic.name, namespace)
            self._out[topic.name, topic.type] = self.advertise(class_, name, profile)
        self._turns = {(message.topic, message.type) for message in bag.messages if begins_turn(message)}
        self._told_time = self.create_publisher(Clock, '/clock', 10) if clock_hz > 0 else None
        steady = NodeClock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(POLL, lambda: self.submit(self._yield_to_learner), clock=steady)
        if clock_hz > 0:
            self.create_timer(1 / clock_hz, lambda: self.submit(self._tell_time), clock=steady)
        self.set_status('waiting for listeners')
        self.submit(partial(self._await_listeners, time.monotonic() + patience))

    def press(self, key: str) -> None:
        """Do what a key stands for; for an unknown one, nothing."""
        self.submit(partial(self._obey, key))

    def _obey(self, key: str) -> None:
        now = time.monotonic()
        if self.over:
            return
        if key == ' ':
            self.playback.pause(now)
        elif key in ('right', 'n'):
            self._publish(self.playback.step(now, turn=True))
        elif key == 's':
            self._publish(self.playback.step(now, turn=False))
        elif key in ('up', 'down'):
            self.playback.change_rate(now, FASTER if key == 'up' else 1 / FASTER)
        elif key == 'q':
            self.over = True
        else:
            return
        self._advance()

    def _await_listeners(self, until: float, heard: int = 0, since: float = 0.0) -> None:
        """Begin once there are listeners and no more of them come: what is not latched would be lost to them."""
        self._yield_to_learner()
        if self.started or self.over:
            return
        now, listeners = time.monotonic(), sum(out.get_subscription_count() for out in self._out.values())
        if listeners != heard:
            since = now
        if now - since >= SETTLED if listeners else now >= until:
            self._advance()
        else:
            self.after(POLL, partial(self._await_listeners, until, listeners, since))

    def _yield_to_learner(self) -> None:
        """End if a live learner has these names: a recorded turn could replace its own before perception sees it."""
        turns = [out.topic_name for key, out in self._out.items() if key in self._turns]
        for topic in turns:
            others = self.other_publishers(topic)
            if others and not self.over:
                self.failure = InputError(
                    f'{others[0]} publishes on {topic}, too; keep the replay apart: --ros-args -r __ns:=/replay'
                )
                self.over = True

    def _advance(self) -> None:
        """Publish what is due, and come again for the next."""
        if self.over:
            return
        if not self.started:
            self.started = True
            self.set_status('playing')
        self._round += 1
        self._publish(self.playback.due(time.monotonic()))
        wait = self.playback.wait(time.monotonic())
        if wait is not None:
            this = self._round
            self.after(max(1e-4, min(wait, LONGEST_WAIT)), lambda: self._advance() if this == self._round else None)
        elif self.playback.done:
            self._finish()

    def _publish(self, messages: Sequence[BagMessage]) -> None:
        for message in messages:
            out = self._out.get((message.topic, message.type))
            if out is not None:
                out.publish(message.data)

    def _finish(self) -> None:
        """Let the last messages arrive: they are gone with their publishers."""
        self.set_status('the end of the bag')
        self._tell_time()
        end = time.monotonic() + LINGER
        for out in self._out.values():
            out.wait_for_all_acked(Duration(seconds=max(0.0, end - time.monotonic())))
        self.over = True

    def _tell_time(self) -> None:
        if self._told_time is not None:
            self._told_time.publish(Clock(clock=header(self.playback.stamp(time.monotonic()), '').stamp))


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
