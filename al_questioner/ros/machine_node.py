"""The node around a machine: topics and timers become events, effects become what ROS does."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from rclpy.clock import Clock
from rclpy.publisher import Publisher

from al_questioner.protocol.effects import (
    ClearTimer,
    Effect,
    End,
    Level,
    Publish,
    Refuse,
    Report,
    Say,
    SetTimer,
    WriteFile,
)
from al_questioner.protocol.events import Entered, Event, Heard, Started, TimerFired
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.performing import perform_all
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.topic_messages import incoming, outgoing, profile_of
from al_questioner.ros.worker import Cancel
from al_questioner.support.files import write_text


class NodeTime:
    """The time of a node, each time it is read.

    Args:
        clock: clock of the node, real or simulated.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock

    @property
    def steady(self) -> float:
        """See `protocol.events.Now`."""
        return time.monotonic()

    @property
    def clock(self) -> int:
        """See `protocol.events.Now`."""
        return int(self._clock.now().nanoseconds)


class MachineNode(QuestionerNode):
    """A node that does what a machine says.

    The machine handles each event on the thread of the node's worker, where its effects are performed, too. Once the
    worker is stopped, the thread that destroys the node may have the machine do what comes last.

    Attributes:
        machine: what it does.
    """

    machine: Machine

    def run(self, machine: Machine) -> None:
        """Take up a machine: subscribe to what it hears, and start it once the worker has done what waits already."""
        self.machine = machine
        self._time = NodeTime(self.get_clock())
        self._alarms: dict[str, Cancel] = {}
        self._tellers: dict[str, Callable[[Any], None]] = {topic: self._teller(topic) for topic in machine.publishes}
        for topic in machine.subscribes:
            self._subscribe(topic)
        self.tell(Started())

    def tell(self, event: Event) -> None:
        """Have the machine handle an event; any thread may call it."""
        self.submit(partial(self._handle, event))

    def enter(self, source: str, content: Any) -> None:
        """Have the machine handle what a person did at this process; any thread may call it."""
        self.tell(Entered(source, content))

    def _handle(self, event: Event) -> None:
        """Have the machine handle an event now, on the worker's thread, and perform the effects one by one."""
        perform_all(self.machine.handle(event, self._time), self.perform)

    def perform(self, effect: Effect) -> None:
        """Do what a machine wants done.

        Raises:
            InputError: a file that cannot be written.
        """
        if isinstance(effect, Publish):
            self._tellers[effect.topic](effect.content)
        elif isinstance(effect, SetTimer):
            self._clear(effect.timer)
            self._alarms[effect.timer] = self.after(effect.seconds, partial(self._ring, effect.timer))
        elif isinstance(effect, ClearTimer):
            self._clear(effect.timer)
        elif isinstance(effect, Refuse):
            self.reject(effect.topic, effect.reason)
        elif isinstance(effect, Report):
            self.set_status(effect.activity, effect.expected_within, effect.awaited)
        elif isinstance(effect, Say):
            self._say(effect)
        elif isinstance(effect, WriteFile):
            write_text(effect.path, effect.text)
        elif isinstance(effect, End):
            self.context.try_shutdown()
        else:
            raise TypeError(f'this node cannot {effect}')

    def health_warning(self) -> str:
        """See `Machine.warning`."""
        return self.machine.warning(self._time)

    def counts(self) -> Mapping[str, int]:
        """See `Machine.counts`."""
        return {**super().counts(), **self.machine.counts()}

    def measurements(self) -> Mapping[str, str]:
        """See `Machine.measurements`."""
        return self.machine.measurements()

    def destroy_node(self) -> None:
        """Stop the worker and leave the graph; then the machine lets go of what it holds, on the calling thread.

        A job that takes longer than `Worker.stop` waits may still run on the worker's thread by then.
        """
        super().destroy_node()
        machine = getattr(self, 'machine', None)
        if machine is not None:
            machine.close()

    def _teller(self, topic: str) -> Callable[[Any], None]:
        """Return a function that publishes on a topic; it does nothing if the message type is not installed."""
        form = outgoing(topic)
        if form is None:
            return lambda _: None
        publisher: Publisher = self.advertise(form.type, topic, profile_of(topic))
        return lambda content: publisher.publish(form.convert(content))

    def _subscribe(self, topic: str) -> None:
        form = incoming(topic)

        def hear(message: Any) -> None:
            self._handle(Heard(topic, form.convert(message)))

        self.on_message(form.type, topic, hear, profile_of(topic))

    def _ring(self, timer: str) -> None:
        self._alarms.pop(timer, None)
        self._handle(TimerFired(timer))

    def _clear(self, timer: str) -> None:
        cancel = self._alarms.pop(timer, None)
        if cancel is not None:
            cancel()

    def _say(self, effect: Say) -> None:
        # One call a level: rclpy forbids that a line of source logs now at one level, now at another.
        logger = self.get_logger()
        if effect.level is Level.INFO:
            logger.info(effect.text)
        elif effect.level is Level.WARNING:
            logger.warning(effect.text)
        else:
            logger.error(effect.text)
