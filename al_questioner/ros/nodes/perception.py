"""The perception node: looks at the simulated table whenever the learner begins a turn."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from sensor_msgs.msg import Image, PointCloud2
from std_msgs.msg import Header

from al_questioner.domain import InputError, Observation, Scene
from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.messages.documents import Document
from al_questioner.messages.pictures import image
from al_questioner.messages.stamps import stamp_of
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, PERCEPTION_SETTINGS
from al_questioner.ros.types import CLOUD_TYPES, header, octets
from al_questioner.ros.worker import Worker
from al_questioner.ros.worlds import check_world, declare_world
from al_questioner.simulation import PerceivedWorld
from al_questioner.simulation.kitchen.table_image import draw_scene


class PerceptionNode(QuestionerNode):
    """Answers every `turn` with the `objects` of that turn, under the turn's stamp.

    The picture for people is drawn by a worker of its own, so that the next turn need not wait for it.
    """

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('perception', **node_arguments)
        self._world_spec = declare_world(self)
        self._given = declare(self, PERCEPTION_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        if not str(self._given['frame_id']).strip():
            raise InputError('parameter frame_id must not be empty: nothing could say where the objects are')
        self._world = PerceivedWorld(self._world_spec.open())
        self._pictured: Scene | None = None
        self._painter = Worker('painter', self._failed)
        self._objects = self.advertise(PointCloud2, 'objects', qos.LATCHED)
        self._picture = self.advertise(Image, 'scene_image', qos.LATCHED)
        if self._given['wait_for_recorder']:
            self.await_recorder('objects')
        self.on_document('turn', self._look)
        for line in self._world.report().splitlines():
            self.get_logger().info(line)
        self.set_status('waiting for a turn', awaited='turn')

    def _look(self, document: Document) -> None:
        check_world(document, self._world_spec)
        turn = document['turn']
        scene = self._world.scene(turn)
        stamp = header(stamp_of(document['stamp']), str(self._given['frame_id']))
        self._objects.publish(cloud_of_scene(scene, stamp, CLOUD_TYPES))
        self.set_status(f'turn {turn}: {len(scene)} objects')
        if scene is not self._pictured:
            self._pictured = scene
            self._painter.submit(partial(self._draw, scene, self._world.observations(turn), stamp))

    def _draw(self, scene: Scene, observations: Sequence[Observation], stamp: Header) -> None:
        """Publish the picture of a scene, unless another scene is there by now."""
        if scene is self._pictured:
            self._picture.publish(image(draw_scene(observations).image, stamp, Image, octets))

    def destroy_node(self) -> None:
        """Stop the painter too."""
        self._painter.stop()
        super().destroy_node()


def main(arguments: Sequence[str]) -> int:
    """Run the node."""
    spin_node(PerceptionNode, arguments)
    return 0
