"""The recorder node: writes what makes up a demonstration into a bag."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.duration import Duration
from rclpy.exceptions import NameValidationException
from rclpy.serialization import deserialize_message
from rclpy.validate_namespace import validate_namespace
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.bags import BagError, BagWriter, Topic
from al_questioner.bags.topics import CLOUD, STRING, TYPES
from al_questioner.domain import EpisodeError, InputError
from al_questioner.messages import documents
from al_questioner.ros import qos
from al_questioner.ros.node import RECORDER, QuestionerNode
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.settings import ALL_NAMES, RECORDER_SETTINGS

CLASSES = {STRING: String, CLOUD: PointCloud2}
EVENTS = ('answer', 'answer_ack', 'decision')
"""Topics that are not latched."""
SYNC_PERIOD = 0.5
"""Seconds from one time at which all is brought to the disk to the next: what a crash can cost."""
DRAIN = 1.0
"""Seconds after the end of an episode in which messages are still taken."""
SECONDS_TO_TELL = Duration(seconds=2.0)
"""Seconds that the end of a failed recording waits for its last /diagnostics to arrive."""


class RecorderNode(QuestionerNode):
    """Writes every message of the recorded topics as it came, by the worker, and brings it to the disk twice a second.

    Attributes:
        until_done: whether it is to end by itself once the episode is over.
        done: whether it is, and all is written.
        failure: what has made the recording impossible.
    """

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__(RECORDER, **node_arguments)
        given = declare(self, RECORDER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        self.done = False
        self.failure: EpisodeError | BagError | None = None
        self.until_done = bool(given['until_done'])
        self._last_turns: dict[str, int] = {}
        self._missed = 0
        self._seen_alive: set[str] = set()
        names = self._names_in_bag(str(given['namespace_in_bag']))
        topics = [Topic(names[name], type_, name not in EVENTS) for name, type_ in TYPES.items()]
        path = Path(str(given['bag'])).expanduser() if given['bag'] else Path(_default_name())
        self._bag = BagWriter(path, topics, str(given['storage']))
        for name, type_ in TYPES.items():
            profile = qos.RECORDED_EVENTS if name in EVENTS else qos.RECORDED_LATCHED
            self.listen(CLASSES[type_], name, self._taker(name, names[name]), profile, raw=True)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(SYNC_PERIOD, lambda: self.submit(self._sync), clock=steady)
        self.set_status(f'recording to {path}')
        self.get_logger().info(f'recording to {path}')

    @property
    def path(self) -> Path:
        """Path of the bag."""
        return self._bag.path

    @property
    def written(self) -> int:
        """Number of messages in the bag."""
        return sum(self._bag.counts.values())

    def counts(self) -> Mapping[str, int]:
        """Number of messages written, by topic, and of turns that were not heard."""
        written = {f'written of {topic}': count for topic, count in self._bag.counts.items()}
        return {**super().counts(), **written, 'turns missed': self._missed}

    def destroy_node(self) -> None:
        """Write what is left and finish the bag, or say on /diagnostics what made that impossible."""
        self._worker.finish()
        try:
            self._bag.close()
        except OSError as error:
            self._fail(error)
        if self.failure is not None and self.context.ok():
            self._publish_diagnostics()
            self._diagnostics.wait_for_all_acked(SECONDS_TO_TELL)
        super().destroy_node()

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

    def _taker(self, name: str, topic: str) -> Callable[[bytes], None]:
        """Make the function that takes the messages of a topic, with the time at which they come."""
        return lambda data: self.submit(partial(self._write, name, topic, bytes(data), time.time_ns()))

    def _write(self, name: str, topic: str, data: bytes, stamp: int) -> None:
        if self.failure is not None:
            return
        try:
            self._bag.write(topic, data, stamp)
        except OSError as error:
            self._fail(error)
            return
        if name in ('turn', 'learner_state'):
            self._look_into(name, data)

    def _look_into(self, name: str, data: bytes) -> None:
        """Say if a turn of an episode was missed; notice its end."""
        try:
            document = documents.read(name, deserialize_message(data, String).data)
        except (InputError, RuntimeError) as error:
            self.reject(name, str(error))
            return
        if name == 'turn':
            episode_id, turn = document['episode_id'], document['turn']
            before = self._last_turns.get(episode_id, 0)
            if episode_id not in self._last_turns:
                self.get_logger().info(f'recording episode {episode_id} from turn {turn} on')
            if turn > before + 1:
                self._missed += turn - before - 1
                self.get_logger().warning(
                    f'turns {before + 1} to {turn - 1} of episode {episode_id} were missed:'
                    ' the recording cannot be used as a demonstration'
                )
            self._last_turns[episode_id] = max(turn, before)
        if document.get('turn') == 1 or not document.get('done', True):
            self._seen_alive.add(document['episode_id'])
        # The latched state of a learner that was done before the recording began is no end of it.
        is_end = name == 'learner_state' and document['done'] and document['episode_id'] in self._seen_alive
        if is_end and self.until_done:
            self.after(DRAIN, self._finish)

    def _finish(self) -> None:
        self._sync()
        self.done = True

    def _sync(self) -> None:
        if self.failure is not None:
            return
        try:
            self._bag.sync()
        except OSError as error:
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        """End the recording: what is on the disk stays as it is, and can be repaired."""
        path, reason = self._bag.path, error.strerror or error
        if not path.exists():
            # It is the same as if the bag could not even have been made.
            self.failure = BagError(f'{path}: cannot be written ({reason})')
            return
        self.failure = EpisodeError(f'{path}: the recording failed ({reason}); afterwards: record --repair {path}')
        self._failed(self.failure)


def _default_name() -> str:
    return f'al_questioner_{datetime.now():%Y_%m_%d-%H_%M_%S}'
