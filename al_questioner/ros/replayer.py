"""The node that plays a bag."""

from __future__ import annotations

import importlib
import time
from collections.abc import Sequence
from typing import Any

from rclpy.clock import Clock as NodeClock
from rclpy.clock_type import ClockType
from rclpy.publisher import Publisher
from rosgraph_msgs.msg import Clock

from al_questioner.domain import InputError
from al_questioner.recording import Bag, BagMessage
from al_questioner.recording.playback import FASTER, Playback
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.types import header

LONGEST_WAIT = 0.5
"""Seconds after which it looks again, however far away the next message is."""


class ReplayNode(QuestionerNode):
    """Publishes the messages of a bag, as they were recorded, when the playback says so.

    Args:
        bag: what is played.
        playback: when.
        delay: seconds before the first message, in which listeners can find the publishers.
        clock_hz: how often the recorded time is published on /clock; 0 for not at all.
    """

    def __init__(self, bag: Bag, playback: Playback, delay: float, clock_hz: float, **node_arguments: Any) -> None:
        self._prefix = common_namespace([topic.name for topic in bag.topics])
        super().__init__('replay', **{'namespace': self._prefix.strip('/'), **node_arguments})
        self.playback = playback
        self.quit = False
        self.turn = 0
        self._round = 0
        self._out: dict[str, Publisher] = {}
        for topic in bag.topics:
            profile = qos.LATCHED if topic.latched else qos.EVENTS
            name = topic.name.removeprefix(self._prefix).lstrip('/') if self._prefix else topic.name
            self._out[topic.name] = self.create_publisher(_message_class(topic.type), name, profile)
        if clock_hz > 0:
            self._told_time = self.create_publisher(Clock, '/clock', 10)
            steady = NodeClock(clock_type=ClockType.STEADY_TIME)
            self.create_timer(1 / clock_hz, self._tell_time, clock=steady)
        self.does('playing')
        self.after(delay, self._advance)

    def press(self, key: str) -> None:
        """Do what a key stands for; an unknown one for nothing."""
        self.submit(lambda: self._obey(key))

    def _obey(self, key: str) -> None:
        now = time.monotonic()
        if key == ' ':
            self.playback.pause(now)
        elif key in ('right', 'n'):
            self._publish(self.playback.step(now, turn=True))
        elif key == 's':
            self._publish(self.playback.step(now, turn=False))
        elif key in ('up', 'down'):
            self.playback.change_rate(now, FASTER if key == 'up' else 1 / FASTER)
        elif key == 'q':
            self.quit = True
        self._advance()

    def _advance(self) -> None:
        """Publish what is due, and come again for the next."""
        self._round += 1
        self._publish(self.playback.due(time.monotonic()))
        wait = self.playback.wait(time.monotonic())
        if wait is not None:
            this = self._round
            self.after(max(1e-4, min(wait, LONGEST_WAIT)), lambda: self._advance() if this == self._round else None)

    def _publish(self, messages: Sequence[BagMessage]) -> None:
        for message in messages:
            self._out[message.topic].publish(message.data)
            self.turn += message.topic.endswith('/turn')

    def _tell_time(self) -> None:
        self._told_time.publish(Clock(clock=header(self.playback.stamp(time.monotonic()), '').stamp))


def common_namespace(topics: Sequence[str]) -> str:
    """The namespace that all of these names lie in, without a slash at its end; empty if there is none.

    >>> common_namespace(['/robot/turn', '/robot/answer'])
    '/robot'
    """
    spaces = {topic.rpartition('/')[0] for topic in topics}
    return spaces.pop() if len(spaces) == 1 else ''


def _message_class(type_: str) -> Any:
    package, _, name = type_.partition('/msg/')
    try:
        return getattr(importlib.import_module(f'{package}.msg'), name)
    except (ImportError, AttributeError) as error:
        raise InputError(f'message type {type_} of the bag is not installed ({error})') from error
