"""Be the teacher: shows each question and publishes what you type, for those without the `ros2` command.

    python3 answer_by_hand.py --ros-args -r __ns:=/my_robot

Type a symbol, `none`, an object's number, feature groups or the numbers of objects with commas between, `?` or `skip`.
"""

import json
import threading
import time

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class AnswerByHand(Node):
    """Prints queries and acknowledgements; `say` answers."""

    def __init__(self) -> None:
        super().__init__('answer_by_hand')
        self.shown: set[tuple[str, str]] = set()
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.answers = self.create_publisher(String, 'answer', 10)
        self.create_subscription(String, 'query', self.show_query, latched)
        self.create_subscription(String, 'answer_ack', self.show_ack, 10)
        self.create_subscription(String, 'learner_state', self.show_state, latched)

    def show_query(self, message: String) -> None:
        """Print a question and what would answer it."""
        query = json.loads(message.data)
        if not self.is_new(query['episode_id'], query['query_id']):
            return
        if query['kind'] == 'feature_subset':
            print(f'\n{query["text"]}  [{",".join(query["choices"])} | ? skip]')
        elif query['kind'] == 'relevance':
            print(f'\n{query["text"]}  [of {",".join(query["choices"])} | none ? skip]')
        else:
            print(f'\n{query["text"]}  [{" ".join(query["choices"])} | none ? skip]')

    def show_ack(self, message: String) -> None:
        """Print whether an answer was taken, and if not, why."""
        ack = json.loads(message.data)
        print('taken' if ack['accepted'] else f'not taken: {ack["reason"]}')

    def show_state(self, message: String) -> None:
        """Print that the episode is over."""
        state = json.loads(message.data)
        if state['done'] and self.is_new(state['episode_id'], 'end'):
            print('the episode is over: there are no more questions')

    def is_new(self, episode_id: str, what: str) -> bool:
        """Whether this was not shown before: the learner says things again, for those who come late."""
        before = len(self.shown)
        self.shown.add((episode_id, what))
        return len(self.shown) > before

    def say(self, word: str) -> None:
        """Publish an answer, once there is a learner to hear it."""
        while rclpy.ok() and not self.answers.get_subscription_count():
            time.sleep(0.1)
        self.answers.publish(String(data=word))


def spin(node: Node) -> None:
    """Spin until the end."""
    try:
        rclpy.spin(node)
    except ExternalShutdownException:
        return


def main() -> None:
    """Read answers until the input ends."""
    rclpy.init()
    node = AnswerByHand()
    thread = threading.Thread(target=spin, args=(node,), daemon=True)
    thread.start()
    try:
        while True:
            if word := input().strip():
                node.say(word)
    except (EOFError, KeyboardInterrupt):
        rclpy.try_shutdown()
        thread.join()


if __name__ == '__main__':
    main()
