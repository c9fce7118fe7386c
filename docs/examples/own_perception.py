"""A robot's own perception, as small as it gets: two coloured blobs, published ten times a second as `objects`.

Run it, in its folder, beside a learner, instead of al_questioner's perception node:

    python3 own_perception.py
    python3 -m al_questioner learner --ros-args -p task:=blobs.yaml -p turns:=10
"""

import contextlib

import numpy as np
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import PointCloud2, PointField

FIELDS = ('x', 'y', 'z', 'object_id', 'colour_redness', 'colour_blueness', 'size_width')


class OwnPerception(Node):
    """Publishes what a camera would see; replace `look` by your own detector."""

    def __init__(self) -> None:
        super().__init__('own_perception')
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.objects = self.create_publisher(PointCloud2, 'objects', latched)
        self.rng = np.random.default_rng(1)
        self.create_timer(0.1, self.publish)

    def look(self) -> np.ndarray:
        """One row per object: position in metres, id, features."""
        points = np.zeros(4, dtype=[(name, 'u4' if name == 'object_id' else 'f4') for name in FIELDS])
        points['object_id'] = [1, 2, 3, 4]
        points['x'] = [0.2, 0.4, 0.6, 0.8]
        points['colour_redness'] = [0.9, 0.8, 0.1, 0.2]
        points['colour_blueness'] = [0.1, 0.2, 0.9, 0.7]
        points['size_width'] = [0.05, 0.11, 0.07, 0.10]
        for feature in FIELDS[4:]:
            points[feature] += self.rng.normal(0, 0.005, len(points))
        return points

    def publish(self) -> None:
        """Send the objects with the time at which they were seen."""
        points = self.look()
        cloud = PointCloud2(height=1, width=len(points), point_step=points.itemsize, row_step=points.nbytes)
        cloud.header.stamp = self.get_clock().now().to_msg()
        cloud.header.frame_id = 'table'
        for index, name in enumerate(FIELDS):
            datatype = PointField.UINT32 if name == 'object_id' else PointField.FLOAT32
            cloud.fields.append(PointField(name=name, offset=4 * index, datatype=datatype, count=1))
        cloud.data = points.tobytes()
        self.objects.publish(cloud)


def main() -> None:
    """Publish until interrupted."""
    rclpy.init()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(OwnPerception())
    rclpy.try_shutdown()


if __name__ == '__main__':
    main()
