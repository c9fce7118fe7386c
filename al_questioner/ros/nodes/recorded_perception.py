"""The node that stands in for perception with the scenes of a bag."""

from __future__ import annotations

from functools import partial
from typing import Any

from rclpy.serialization import deserialize_message
from sensor_msgs.msg import PointCloud2

from al_questioner.bags.scenes import RecordedScenes
from al_questioner.domain import InputError
from al_questioner.protocol.recorded_perception import PRESSED, RecordedPerceptionMachine
from al_questioner.ros.machine_node import MachineNode


class RecordedPerceptionNode(MachineNode):
    """Runs a `RecordedPerceptionMachine` with the scenes of a bag."""

    machine: RecordedPerceptionMachine

    def __init__(self, scenes: RecordedScenes, **node_arguments: Any) -> None:
        super().__init__('replay', **node_arguments)
        clouds = {turn: cloud.data for turn, cloud in scenes.clouds.items()}
        others = partial(self.other_publishers, 'objects')
        self.run(RecordedPerceptionMachine(clouds, scenes.world, _count_points, others))

    @property
    def turn(self) -> int:
        """The live turn that was answered last."""
        return self.machine.turn

    @property
    def over(self) -> bool:
        """True once it was told to quit, or failed."""
        return self.machine.over

    @property
    def failure(self) -> InputError | None:
        """Reason why it must not go on."""
        return self.machine.failure

    def press(self, key: str) -> None:
        """Quit, if the key stands for that; any thread may call it."""
        self.enter(PRESSED, key)


def _count_points(data: bytes) -> int:
    cloud = deserialize_message(data, PointCloud2)
    return int(cloud.width * cloud.height)
