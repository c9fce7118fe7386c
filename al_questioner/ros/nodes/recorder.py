"""The recorder node: writes what makes up a demonstration into a bag."""

from __future__ import annotations

import time
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException
from rclpy.serialization import deserialize_message
from rclpy.validate_namespace import validate_namespace
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.bags import BagError, BagWriter, Topic
from al_questioner.bags.topics import CLOUD, STRING, TYPES
from al_questioner.domain import EpisodeError, InputError
from al_questioner.protocol.effects import CloseBag, Effect, Record, SyncBag
from al_questioner.protocol.events import Heard
from al_questioner.protocol.performing import perform_all
from al_questioner.protocol.recorder import RecorderMachine
from al_questioner.protocol.topics import TOPICS, Delivery, Recorded
from al_questioner.ros import qos
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.node import RECORDER
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.settings import ALL_NAMES, RECORDER_SETTINGS

CLASSES = {STRING: String, CLOUD: PointCloud2}
SECONDS_TO_TELL = Duration(seconds=2.0)
"""Seconds that the end of a failed recording waits for its last /diagnostics to arrive."""


class RecorderNode(MachineNode):
    """Runs a `RecorderMachine` on raw messages, and writes the bag for it."""

    machine: RecorderMachine

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(RECORDER, **node_arguments)
        given = declare(self, RECORDER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        self._names = self._names_in_bag(str(given['namespace_in_bag']))
        topics = [Topic(self._names[name], type_, is_latched(name)) for name, type_ in TYPES.items()]
        path = Path(str(given['bag'])).expanduser() if given['bag'] else Path(_default_name())
        self._bag = BagWriter(path, topics, str(given['storage']))
        self.run(RecorderMachine(path, self._names, bool(given['until_done']), partial(failure_of, path)))

    def perform(self, effect: Effect) -> None:
        """See `MachineNode.perform`; an OSError comes back from a bag that cannot be written to."""
        if isinstance(effect, Record):
            self._bag.write(self._names[effect.topic], effect.data, effect.stamp)
        elif isinstance(effect, SyncBag):
            self._bag.sync()
        elif isinstance(effect, CloseBag):
            self._bag.close()
        else:
            super().perform(effect)

    def destroy_node(self) -> None:
        """Write what is left and finish the bag, or say on /diagnostics what made that impossible.

        The worker writes what is left, on its thread; then the calling thread finishes the bag.
        """
        self._worker.finish()
        try:
            perform_all(self.machine.finish(), self.perform)
        except EpisodeError as error:
            self._failed(error)
        if self.machine.failure is not None and self.context.ok():
            self._publish_diagnostics()
            self._diagnostics.wait_for_all_acked(SECONDS_TO_TELL)
        super().destroy_node()

    def _subscribe(self, topic: str) -> None:
        """Have every message of a topic taken as it comes, however many wait."""

        def take(message: bytes) -> None:
            data = bytes(message)
            self.tell(Heard(topic, Recorded(data, time.time_ns(), partial(text_of, data))))

        profile = qos.RECORDED_LATCHED if is_latched(topic) else qos.RECORDED_EVENTS
        self.listen(CLASSES[TYPES[topic]], topic, take, profile, raw=True)

    def _names_in_bag(self, namespace: str) -> dict[str, str]:
        """Return the names of the topics in the bag, by their last names.

        Raises:
            InputError: the namespace is none.
        """
        names = {name: self.resolve_topic_name(name) for name in TYPES}
        if not namespace:
            return names
        wanted = f'/{namespace.strip("/")}'
        try:
            validate_namespace(wanted)
        except NameValidationException as error:
            raise InputError(f'parameter namespace_in_bag: {" ".join(str(error).split())}') from error
        own = self.get_namespace().rstrip('/')
        return {
            name: wanted.rstrip('/') + topic.removeprefix(own) if topic.startswith(f'{own}/') else topic
            for name, topic in names.items()
        }


def is_latched(topic: str) -> bool:
    """Return whether late listeners hear the last message of a topic."""
    return TOPICS[topic] is Delivery.LATCHED


def text_of(data: bytes) -> str:
    """Return the text of a String message.

    Raises:
        InputError: it is none.
    """
    try:
        return str(deserialize_message(data, String).data)
    except RuntimeError as error:
        raise InputError(str(error)) from error


def failure_of(path: Path, error: OSError) -> EpisodeError | BagError:
    """Return what is wrong when a bag cannot be written to any more: an EpisodeError if it can be repaired."""
    reason = error.strerror or error
    if not path.exists():
        # It is the same as if the bag could not even have been made.
        return BagError(f'{path}: cannot be written ({reason})')
    return EpisodeError(f'{path}: the recording failed ({reason}); afterwards: record --repair {path}')


def _default_name() -> str:
    return f'al_questioner_{datetime.now():%Y_%m_%d-%H_%M_%S}'
