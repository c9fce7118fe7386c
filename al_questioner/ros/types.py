"""Message classes of ROS, as the encoders of `messages/` need them, and time stamps as numbers."""

from __future__ import annotations

from array import array

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, PoseStamped, PoseWithCovariance, Vector3
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import ColorRGBA, Header, String
from visualization_msgs.msg import Marker, MarkerArray

from al_questioner.messages.clouds import CloudTypes
from al_questioner.messages.markers import MarkerTypes
from al_questioner.messages.recognition import DetectionTypes
from al_questioner.messages.stamps import SECOND


def octets(content: bytes) -> array[int]:
    """Return bytes in the one type that a generated message accepts without checking each."""
    return array('B', content)


CLOUD_TYPES = CloudTypes(cloud=PointCloud2, field=PointField, octets=octets)
MARKER_TYPES = MarkerTypes(
    array=MarkerArray, marker=Marker, pose=Pose, point=Point, vector=Vector3, colour=ColorRGBA, constants=Marker
)


def header(stamp: int, frame_id: str) -> Header:
    """Return a header with a stamp in nanoseconds."""
    return Header(stamp=Time(sec=stamp // SECOND, nanosec=stamp % SECOND), frame_id=frame_id)


def text(content: str) -> String:
    """Return a String message."""
    return String(data=content)


def pose(head: Header, position: tuple[float, float, float]) -> PoseStamped:
    """Return a pose at a position in metres, turned as the frame of the header is."""
    x, y, z = position
    return PoseStamped(header=head, pose=Pose(position=Point(x=x, y=y, z=z)))


def detection_types() -> DetectionTypes | None:
    """Return the message classes of detections; None where vision_msgs is not installed."""
    try:
        from vision_msgs.msg import Detection3D, Detection3DArray, ObjectHypothesis, ObjectHypothesisWithPose
    except ImportError:
        return None
    return DetectionTypes(
        array=Detection3DArray,
        detection=Detection3D,
        result=ObjectHypothesisWithPose,
        hypothesis=ObjectHypothesis,
        pose_with_covariance=PoseWithCovariance,
        pose=Pose,
        point=Point,
    )
