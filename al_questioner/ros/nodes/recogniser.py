"""The recogniser node: tells what the things in view are taken for, and where the wanted one is."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from geometry_msgs.msg import PoseStamped
from rclpy.publisher import Publisher
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header, String
from visualization_msgs.msg import MarkerArray

from al_questioner.domain import InputError, Knowledge, Recognition, Scene
from al_questioner.event_log.log import read_log
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages.clouds import scene_of_cloud
from al_questioner.messages.concepts_file import concepts_of_text, read_concepts
from al_questioner.messages.markers import recognised_markers
from al_questioner.messages.recognition import (
    cloud_of_recognition,
    detections_of_recognition,
    finding_members,
    recognition_members,
)
from al_questioner.messages.stamps import nanoseconds
from al_questioner.questioning import SceneRecogniser
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.parameters import Value, declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, RECOGNISER_SETTINGS
from al_questioner.ros.types import CLOUD_TYPES, MARKER_TYPES, detection_types, pose

NO_EPISODE = 'none'
"""The `episode_id` of documents as long as nothing is known that comes from an episode."""


class Seen(NamedTuple):
    """Newest cloud that could be read."""

    header: Header
    scene: Scene


class Known(NamedTuple):
    """Knowledge of a file or a session.

    Attributes:
        source: its path, as it was given.
        fault: what is wrong with the log of a session, and where; empty if nothing is.
    """

    knowledge: Knowledge
    source: str
    fault: str = ''


class RecogniserNode(QuestionerNode):
    """Recognises the things of every cloud, and finds what somebody wants.

    Everything happens on the worker's thread, message by message. While it learns, which for a large file takes
    seconds, the newest cloud waits.

    Attributes:
        recogniser: what it does without ROS.
    """

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('recogniser', **node_arguments)
        given = declare(self, RECOGNISER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        # What cannot be used is to be said before anything is published.
        known = known_already(given)
        self.episode_id = NO_EPISODE
        self.recogniser = SceneRecogniser(float(given['threshold']))
        self._seen: Seen | None = None
        self._clouds = 0
        self._cloud = self.advertise(PointCloud2, 'recognised', qos.LATCHED)
        self._markers = self.advertise(MarkerArray, 'recognised_markers', qos.LATCHED)
        self._tell = self.document_publisher('recognition')
        self._detect = self._detector()
        self._target = self.advertise(PoseStamped, 'target', qos.EVENTS)
        self._tell_target = self.document_publisher('target_info', qos.EVENTS)
        if known is None:
            self.on_message(
                String, 'concepts', lambda message: self._learn(concepts_of_text(message.data)), qos.LATCHED
            )
            self.set_status('waiting for what a learner knows', awaited='concepts')
        else:
            if known.fault:
                self.get_logger().warning(f'{known.source}: {known.fault}; what comes before it is taken')
            self.set_status(f'learning what {known.source} holds')
            self.submit(partial(self._learn, known.knowledge))
        self.on_message(PointCloud2, 'objects', self._look, qos.LATCHED)
        self.on_message(String, 'want', self._find, qos.EVENTS)

    def counts(self) -> Mapping[str, int]:
        """Return the counters of the node, with what it has recognised and by how much."""
        recognition = self.recogniser.recognition
        told = (
            {} if recognition is None else {'things in view': len(recognition.things), 'examples': recognition.examples}
        )
        return {**super().counts(), 'clouds recognised': self._clouds, **told}

    def _learn(self, knowledge: Knowledge) -> None:
        """Learn what is known, and see the last things with other eyes."""
        self.episode_id = knowledge.origins[-1].episode if knowledge.origins else NO_EPISODE
        before = self.recogniser.recognition
        try:
            self.recogniser.follow(knowledge)
        finally:
            if self.recogniser.concepts is None:
                self.set_status('nothing has been taught yet')
                if before is not None and self._seen is not None:
                    # Another learner has begun: what is latched are names that nobody knows any more.
                    self._publish(replace(before, examples=0, things=()), self._seen.header)
        if self.recogniser.concepts is None:
            return
        if self._seen is None:
            self.set_status('waiting for objects', awaited='objects')
        else:
            try:
                self._recognise(self._seen)
            except InputError as error:
                # The concepts are taken: it is the things that they are not of.
                self.reject('objects', str(error))

    def _look(self, cloud: PointCloud2) -> None:
        self._seen = Seen(cloud.header, scene_of_cloud(cloud, self.recogniser.feature_names))
        self._recognise(self._seen)

    def _recognise(self, seen: Seen) -> None:
        """Recognise the things in view, and publish what they are taken for."""
        recognition = self.recogniser.look(seen.scene)
        if recognition is None:
            return
        self._publish(recognition, seen.header)
        self._clouds += 1
        self.set_status('recognising')

    def _publish(self, recognition: Recognition, head: Header) -> None:
        """Publish what things are taken for, in each of its forms."""
        # The forms for programs first: markers take longest to write.
        self._cloud.publish(cloud_of_recognition(recognition, head, CLOUD_TYPES))
        self._tell(recognition_members(recognition, nanoseconds(head.stamp), head.frame_id))
        if self._detect is not None:
            self._detect(recognition, head)
        self._markers.publish(recognised_markers(recognition, head, MARKER_TYPES))

    def _find(self, message: String) -> None:
        """Publish where the most probable thing is of what is wanted, or why there is none."""
        finding, seen = self.recogniser.find(message.data), self._seen
        where = () if seen is None else (nanoseconds(seen.header.stamp), seen.header.frame_id)
        if finding.target is not None and seen is not None:
            self._target.publish(pose(seen.header, finding.target.position))
        self._tell_target(finding_members(finding, *where))
        if finding.symbol is None and self.recogniser.concepts is not None:
            raise InputError(finding.reason)

    def _detector(self) -> Callable[[Recognition, Header], None] | None:
        """Make a function that publishes detections; None where their message type is not installed."""
        types = detection_types()
        if types is None:
            return None
        publisher: Publisher = self.advertise(types.array, 'detections', qos.LATCHED)
        return lambda recognition, head: publisher.publish(detections_of_recognition(recognition, head, types))


def known_already(given: Mapping[str, Value]) -> Known | None:
    """Return what is known by the parameters; None if that is left to a learner.

    Raises:
        InputError: it cannot be used, or both a file and a session are named.
    """
    file, folder = str(given['concepts']), str(given['session'])
    if file and folder:
        raise InputError('give one of the parameters concepts and session, not both')
    if file:
        return Known(read_concepts(Path(file).expanduser()), file)
    if folder:
        path = Path(folder).expanduser()
        summary = summarise_session(path, read_log(path))
        return Known(summary.knowledge, folder, summary.fault or '')
    return None


def main(arguments: Sequence[str]) -> int:
    """Run the node."""
    spin_node(RecogniserNode, arguments)
    return 0
