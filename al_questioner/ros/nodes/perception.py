"""The perception node: looks at the simulated table whenever the learner begins a turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import InputError, Observation
from al_questioner.protocol.effects import Effect, Publish
from al_questioner.protocol.perception import PerceptionMachine
from al_questioner.protocol.topics import PictureToDraw
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, PERCEPTION_SETTINGS
from al_questioner.ros.worker import Worker
from al_questioner.ros.worlds import declare_world, world_members
from al_questioner.simulation import PerceivedWorld
from al_questioner.simulation.kitchen.table_image import draw_scene

WAITING_PICTURES = 1
"""Largest number of pictures that are still to be drawn: of a scene that has gone nobody needs one."""


class PerceptionNode(MachineNode):
    """Runs a `PerceptionMachine` with the world that the parameters ask for.

    The picture for people is drawn by a worker of its own, so that the next turn need not wait for it.
    """

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('perception', **node_arguments)
        world = declare_world(self)
        given = declare(self, PERCEPTION_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        frame_id = str(given['frame_id'])
        if not frame_id.strip():
            raise InputError('parameter frame_id must not be empty: nothing could say where the objects are')
        seen = PerceivedWorld(world.open())
        self._painter = Worker('painter', self._failed)
        self._order = self._painter.inbox(self._paint, WAITING_PICTURES)
        if given['wait_for_recorder']:
            self.await_recorder('objects')
        for line in seen.report().splitlines():
            self.get_logger().info(line)
        self.run(PerceptionMachine(seen, world_members(world), frame_id, _drawn))

    def perform(self, effect: Effect) -> None:
        """See `MachineNode.perform`; a picture is left to the painter."""
        if isinstance(effect, Publish) and isinstance(effect.content, PictureToDraw):
            self._order(effect)
        else:
            super().perform(effect)

    def _paint(self, effect: Publish) -> None:
        super().perform(Publish(effect.topic, effect.content.drawn()))

    def destroy_node(self) -> None:
        """Stop the painter too."""
        self._painter.stop()
        super().destroy_node()


def _drawn(observations: Sequence[Observation]) -> NDArray[np.uint8]:
    return draw_scene(observations).image


def main(arguments: Sequence[str]) -> int:
    """Run the node."""
    spin_node(PerceptionNode, arguments)
    return 0
