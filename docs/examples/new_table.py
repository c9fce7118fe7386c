"""A simulated table that no learner has seen, published as `objects`; shows what a recogniser takes its things for.

    python3 new_table.py --sample 0 --number 0 --ros-args -r __ns:=/my_robot

Type what you want (`snack`): it is said on `want`, and what comes back on `target_info` is printed.
"""

import argparse
import json
import sys
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.utilities import remove_ros_args
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Header, String

from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.ros.types import CLOUD_TYPES
from al_questioner.simulation import PerceivedWorld, WorldSpec, load_task

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
NONE = 'none'


class NewTable(Node):
    """Publishes a held-out table, and compares what is said of it with the truth."""

    def __init__(self, given: argparse.Namespace) -> None:
        super().__init__('new_table')
        task = load_task(given.task).of_sample(given.sample)
        scene, table = PerceivedWorld(WorldSpec(task, given.sample, given.sample).open()).new_table(given.number)
        self.truth = table.symbols
        self.objects = self.create_publisher(PointCloud2, 'objects', LATCHED)
        self.wish = self.create_publisher(String, 'want', 10)
        self.create_subscription(String, 'recognition', self.compare, LATCHED)
        self.create_subscription(String, 'target_info', self.show_target, 10)
        self.told = ''
        self.seen_at = self.get_clock().now().to_msg()
        cloud = cloud_of_scene(scene, Header(stamp=self.seen_at, frame_id='table'), CLOUD_TYPES)
        self.objects.publish(cloud)
        # Again and again, as a camera does.
        self.create_timer(1.0, lambda: self.objects.publish(cloud))
        print(f'{len(scene)} things are on the table.', flush=True)

    def compare(self, message: String) -> None:
        """Print how many things are taken for what they are."""
        document = json.loads(message.data)
        if document['stamp'] != {'sec': self.seen_at.sec, 'nanosec': self.seen_at.nanosec}:
            # It is of another table, which was there before.
            return
        called = {each['object_id']: each['best'] for each in document['things'] if each['known']}
        right = {thing for thing, name in called.items() if name == self.truth[thing]}
        of_symbol = [thing for thing, name in self.truth.items() if name != NONE]
        rightly = sum(thing in right for thing in of_symbol)
        told = (
            f'It says what {len(called)} things are, and is right about {len(right)};'
            f' of the {len(of_symbol)} things of some symbol it names {rightly} rightly.'
        )
        if told != self.told:
            print(told, flush=True)
        self.told = told

    def show_target(self, message: String) -> None:
        """Print the answer to a wish."""
        print(json.loads(message.data)['text'], flush=True)


def spin(node: Node) -> None:
    """Spin until the end."""
    try:
        rclpy.spin(node)
    except ExternalShutdownException:
        return


def main() -> None:
    """Publish, and read wishes until the input ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--task', default='kitchen_table', help='whose things lie on the table (%(default)s)')
    parser.add_argument('--sample', type=int, default=0, help='of the task: which kinds of things (%(default)s)')
    parser.add_argument('--number', type=int, default=0, help='of the table (%(default)s)')
    given = parser.parse_args(remove_ros_args(sys.argv)[1:])
    rclpy.init()
    node = NewTable(given)
    thread = threading.Thread(target=spin, args=(node,), daemon=True)
    thread.start()
    try:
        while True:
            if word := input().strip():
                node.wish.publish(String(data=word))
    except (EOFError, KeyboardInterrupt):
        rclpy.try_shutdown()
        thread.join()


if __name__ == '__main__':
    main()
