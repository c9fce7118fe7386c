"""The message classes of ROS, as the encoders of `messages/` want them, and time stamps as numbers."""

from __future__ import annotations

from array import array

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Point, Pose, Vector3
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import ColorRGBA, Header, String
from visualization_msgs.msg import Marker, MarkerArray

from al_questioner.messages.clouds import CloudTypes
from al_questioner.messages.documents import Document
from al_questioner.messages.pictures import MarkerTypes

NANOSECONDS = 1_000_000_000


def octets(content: bytes) -> array[int]:
    """Bytes in the one form that a generated message takes without looking at each."""
    return array('B', content)


CLOUD_TYPES = CloudTypes(cloud=PointCloud2, field=PointField, octets=octets)
MARKER_TYPES = MarkerTypes(
    array=MarkerArray, marker=Marker, pose=Pose, point=Point, vector=Vector3, colour=ColorRGBA, constants=Marker
)


def nanoseconds(stamp: Time) -> int:
    """A stamp as nanoseconds since the epoch of its clock."""
    return int(stamp.sec) * NANOSECONDS + int(stamp.nanosec)


def header(stamp: int, frame_id: str) -> Header:
    """A header with a stamp in nanoseconds."""
    return Header(stamp=Time(sec=stamp // NANOSECONDS, nanosec=stamp % NANOSECONDS), frame_id=frame_id)


def stamp_members(stamp: int) -> Document:
    """A stamp in nanoseconds as the member of a document."""
    return {'sec': stamp // NANOSECONDS, 'nanosec': stamp % NANOSECONDS}


def stamp_of(members: Document) -> int:
    """The inverse of `stamp_members`."""
    return int(members['sec']) * NANOSECONDS + int(members['nanosec'])


def text(content: str) -> String:
    """A String message."""
    return String(data=content)
