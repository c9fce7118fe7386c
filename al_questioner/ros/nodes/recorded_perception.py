"""The node that stands in for perception with the scenes of a bag."""

from __future__ import annotations

from typing import Any

from rclpy.serialization import deserialize_message
from sensor_msgs.msg import PointCloud2

from al_questioner.bags.scenes import RecordedScenes
from al_questioner.domain import InputError
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import stamp_of
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.types import header

WORLD = ('task', 'seed', 'sample')
"""Members of a document that describe a simulated world."""


class RecordedPerceptionNode(QuestionerNode):
    """Answers every `turn` of a live learner with the `objects` of the recorded turn, under the live turn's stamp.

    Only the stamp is another one: recorded ones lie in the past, and a learner takes no scene from before its turn.

    Attributes:
        turn: the live turn that was answered last.
        over: whether it was told to quit, or failed.
        failure: why it must not go on.
    """

    def __init__(self, scenes: RecordedScenes, **node_arguments: Any) -> None:
        super().__init__('replay', **node_arguments)
        self.turn = 0
        self.over = False
        self.failure: InputError | None = None
        self._scenes = scenes
        self._strange_worlds: set[str] = set()
        self._objects = self.advertise(PointCloud2, 'objects', qos.LATCHED)
        self.on_document('turn', self._look)
        self.set_status('waiting for a turn')

    def press(self, key: str) -> None:
        """Quit, if the key stands for that."""
        if key == 'q':
            self.over = True

    def _look(self, document: Document) -> None:
        others = self.other_publishers('objects')
        if others:
            self.failure = InputError(f'{others[0]} shows objects, too; the learner would see now this, now that')
            self.over = True
        if self.over:
            return
        turn = document['turn']
        recorded = self._scenes.clouds.get(turn)
        if recorded is None:
            raise InputError(f'no scene of turn {turn} was recorded, the last is that of {max(self._scenes.clouds)}')
        self._compare_worlds(document)
        cloud = deserialize_message(recorded.data, PointCloud2)
        cloud.header = header(stamp_of(document['stamp']), cloud.header.frame_id)
        self._objects.publish(cloud)
        self.turn = turn
        self.set_status(f'turn {turn}: {cloud.width * cloud.height} objects')

    def _compare_worlds(self, document: Document) -> None:
        """Say if the learner speaks of another world: a person can teach it nevertheless, the script cannot."""
        ours, theirs = self._scenes.world, document['world']
        if ours is None or theirs is None or document['episode_id'] in self._strange_worlds:
            return
        differing = [
            f'{name} {theirs[name]!r}, recorded {ours[name]!r}' for name in WORLD if theirs[name] != ours[name]
        ]
        if differing:
            self._strange_worlds.add(document['episode_id'])
            self.get_logger().warning(
                f'the learner has {"; ".join(differing)}: the scripted teacher would answer about other things'
            )
