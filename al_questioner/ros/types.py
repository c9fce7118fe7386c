"""Message classes of ROS, as the encoders of `messages/` need them, and time stamps as numbers."""

from __future__ import annotations

from array import array

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Vector3
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import ColorRGBA, Header, String
from visualization_msgs.msg import Marker, MarkerArray

from al_questioner.messages.clouds import CloudTypes
from al_questioner.messages.pictures import MarkerTypes
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
