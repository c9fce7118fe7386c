"""The message of each topic, and what the machines say and hear in its place."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from geometry_msgs.msg import PoseStamped
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message
from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import String
from visualization_msgs.msg import MarkerArray

from al_questioner.domain import Scene
from al_questioner.messages.clouds import cloud_of_decision, cloud_of_scene, scene_of_cloud
from al_questioner.messages.markers import markers, recognised_markers
from al_questioner.messages.pictures import image, picture_of_image
from al_questioner.messages.recognition import cloud_of_recognition, detections_of_recognition
from al_questioner.messages.stamps import nanoseconds
from al_questioner.protocol.topics import (
    TOPICS,
    BeliefsShown,
    DecisionMade,
    Delivery,
    Look,
    PictureShown,
    Place,
    RecognitionShown,
    Replayed,
    SceneShown,
)
from al_questioner.ros import qos
from al_questioner.ros.types import CLOUD_TYPES, MARKER_TYPES, detection_types, header, octets, pose, text


class Form(NamedTuple):
    """Form of what is said or heard on a topic.

    Attributes:
        type: class of the message.
        convert: makes the message of what is said; or, of a message, what is heard.
    """

    type: type
    convert: Callable[[Any], Any]


def profile_of(topic: str) -> QoSProfile:
    """Return the quality of service of a topic."""
    return qos.LATCHED if TOPICS[topic] is Delivery.LATCHED else qos.EVENTS


def outgoing(topic: str) -> Form | None:
    """Return the form of what is said on a topic; None if its message type is not installed."""
    if topic == 'detections':
        return _detections()
    form: Form = OUTGOING.get(topic, Form(String, text))
    return form


def incoming(topic: str) -> Form:
    """Return the form of what is heard on a topic."""
    return INCOMING.get(topic, Form(String, lambda message: message.data))


def look_of(cloud: PointCloud2) -> Look:
    """Return a cloud as the machines hear it: read when they know which features to expect."""

    def read(known_features: Sequence[str]) -> Scene:
        return scene_of_cloud(cloud, known_features)

    return Look(nanoseconds(cloud.header.stamp), cloud.header.frame_id, read)


def _picture_of(message: Image) -> PictureShown:
    return PictureShown(picture_of_image(message), nanoseconds(message.header.stamp), message.header.frame_id)


def _cloud_of(shown: SceneShown | Replayed) -> Any:
    if isinstance(shown, SceneShown):
        return cloud_of_scene(shown.scene, header(shown.stamp, shown.frame_id), CLOUD_TYPES)
    cloud = deserialize_message(shown.data, PointCloud2)
    cloud.header = header(shown.stamp, cloud.header.frame_id)
    return cloud


def _image_of(shown: PictureShown) -> Any:
    return image(shown.picture, header(shown.stamp, shown.frame_id), Image, octets)


def _decision_of(made: DecisionMade) -> Any:
    head = header(made.stamp, made.frame_id)
    return cloud_of_decision(made.decision, made.symbols, head, CLOUD_TYPES, made.scene)


def _markers_of(shown: BeliefsShown) -> Any:
    head = header(shown.stamp, shown.frame_id)
    return markers(shown.scene, shown.beliefs, shown.symbols, shown.asked, head, MARKER_TYPES, shown.question)


def _recognised_of(shown: RecognitionShown) -> Any:
    return cloud_of_recognition(shown.recognition, header(shown.stamp, shown.frame_id), CLOUD_TYPES)


def _recognised_markers_of(shown: RecognitionShown) -> Any:
    return recognised_markers(shown.recognition, header(shown.stamp, shown.frame_id), MARKER_TYPES)


def _pose_of(place: Place) -> Any:
    return pose(header(place.stamp, place.frame_id), place.position)


def _detections() -> Form | None:
    types = detection_types()
    if types is None:
        return None
    return Form(
        types.array,
        lambda shown: detections_of_recognition(shown.recognition, header(shown.stamp, shown.frame_id), types),
    )


OUTGOING: Mapping[str, Form] = {
    'objects': Form(PointCloud2, _cloud_of),
    'scene_image': Form(Image, _image_of),
    'decision': Form(PointCloud2, _decision_of),
    'scene_markers': Form(MarkerArray, _markers_of),
    'recognised': Form(PointCloud2, _recognised_of),
    'recognised_markers': Form(MarkerArray, _recognised_markers_of),
    'target': Form(PoseStamped, _pose_of),
}
"""Forms of what is said, apart from texts."""

INCOMING: Mapping[str, Form] = {'objects': Form(PointCloud2, look_of), 'scene_image': Form(Image, _picture_of)}
"""Forms of what is heard, apart from texts."""
