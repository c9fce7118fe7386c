"""A flood of garbage clouds: nothing crashes, nothing is learnt, and the learner goes on."""

from __future__ import annotations

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2, PointField

from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.learner import LearnerOptions
from al_questioner.protocol.topics import SceneShown
from al_questioner.ros.topic_messages import incoming, outgoing
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.learner_robot import Robot
from shared.lunches import TASK, WORLD_SPEC

MESSAGES = 25_000


@pytest.mark.slow
def test_a_flood_of_garbage_clouds_is_refused() -> None:
    """Otherwise a driver with another layout would end the episode, or have it learn from noise."""
    world = PerceivedWorld(WORLD_SPEC.open())
    robot = Robot(world, None, episode_settings(TASK, 'random_fsq', 6.0, 8), LearnerOptions())
    robot.driver.start()
    said, heard = outgoing('objects'), incoming('objects')
    assert said is not None
    good = said.convert(SceneShown(world.scene(1), stamp_of(robot.said('turn')[0]['stamp']), 'table'))
    rng = np.random.default_rng(1)
    for _ in range(MESSAGES):
        robot.driver.hear('objects', heard.convert(damaged(good, rng)))
    assert [topic for topic, _ in robot.driver.refusals] == ['objects'] * MESSAGES
    assert robot.said('query') == []
    robot.driver.hear('objects', heard.convert(good))
    assert len(robot.said('query')) == 1


def damaged(good: PointCloud2, rng: np.random.Generator) -> PointCloud2:
    """A cloud that cannot be a scene: of another size, step or layout, cut off, or with a position that is NaN."""
    cloud = PointCloud2(
        header=good.header, height=good.height, width=good.width, fields=good.fields,
        is_bigendian=good.is_bigendian, point_step=good.point_step, row_step=good.row_step, data=good.data,
    )  # fmt: skip
    damage = rng.integers(6)
    if damage == 0:
        cloud.width = int(rng.integers(good.width + 1, 2**32))
    elif damage == 1:
        cloud.point_step = int(rng.integers(0, good.point_step))
    elif damage == 2:
        missing = str(rng.choice(['x', 'y', 'z', 'object_id']))
        cloud.fields = [field for field in good.fields if field.name != missing]
    elif damage == 3:
        cloud.data = good.data[: int(rng.integers(len(good.data)))]
    elif damage == 4:
        last = good.fields[-1]
        far = PointField(name=last.name, offset=2**31 - 1, datatype=last.datatype, count=last.count)
        cloud.fields = [*good.fields[:-1], far]
    else:
        cloud.data = np.float32(np.nan).tobytes() + bytes(good.data)[4:]
    return cloud
