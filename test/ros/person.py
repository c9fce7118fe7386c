"""A person with nothing but `ros2 topic pub`, as a script: answers every query with a plain word."""

import contextlib
import json

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class Person(Node):
    """Knows that things 1 and 2 of the example are red, and 3 and 4 blue."""

    def __init__(self) -> None:
        super().__init__('person')
        self.answers = self.create_publisher(String, 'answer', 10)
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.query: dict[str, object] = {}
        self.create_subscription(String, 'query', self.hear, latched)
        self.create_timer(0.1, self.answer)

    def hear(self, message: String) -> None:
        """Remember the question."""
        self.query = json.loads(message.data)

    def answer(self) -> None:
        """Say it, and say it again as long as nobody asks another question."""
        if self.query:
            red = self.query['object_id'] in (1, 2)
            word = 'colour' if self.query['kind'] == 'feature_subset' else 'red_thing' if red else 'blue_thing'
            self.answers.publish(String(data=word))


rclpy.init()
with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
    rclpy.spin(Person())
