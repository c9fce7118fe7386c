"""The machine that looks at a simulated table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from al_questioner.domain import Scene
from al_questioner.messages.stamps import stamp_members
from al_questioner.protocol.perception import PerceptionMachine
from al_questioner.protocol.topics import PictureToDraw, SceneShown
from shared.machine_driver import Driver
from shared.scenes import make_scene

WORLD = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}


class Table:
    """A table that changes every two turns; what is observed of it is the number of the change."""

    def __init__(self) -> None:
        self._scenes = [make_scene(np.zeros((n, 1)), None, ('colour_hue',)) for n in range(1, 5)]

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn."""
        return self._scenes[turn // 2]

    def observations(self, turn: int) -> Sequence[Any]:
        """Return what is observed."""
        return [turn // 2]


@pytest.fixture
def drawn() -> list[Any]:
    return []


@pytest.fixture
def driver(drawn: list[Any]) -> Driver:
    def draw(observations: Sequence[Any]) -> NDArray[np.uint8]:
        drawn.append(observations)
        return np.zeros((2, 3, 3), np.uint8)

    driver = Driver(PerceptionMachine(Table(), WORLD, 'table', draw))
    driver.start()
    return driver


def begin(driver: Driver, turn: int, stamp: int = 5, world: Any = None) -> None:
    """Begin a turn."""
    driver.hear_document('turn', 'e', {'turn': turn, 'stamp': stamp_members(stamp), 'world': world})


def test_every_turn_gets_its_objects_under_its_stamp(driver: Driver) -> None:
    """Otherwise the learner would wait, or take what it sees for that of another turn."""
    assert driver.status == 'waiting for a turn'
    for turn, stamp in ((1, 10), (2, 20), (2, 20), (3, 30)):
        begin(driver, turn, stamp)
        assert driver.status == f'turn {turn}: {turn // 2 + 1} objects'
    shown: list[SceneShown] = driver.published('objects')
    assert [(one.stamp, len(one.scene), one.frame_id) for one in shown] == [
        (10, 1, 'table'), (20, 2, 'table'), (20, 2, 'table'), (30, 2, 'table'),
    ]  # fmt: skip


def test_a_picture_is_told_of_once_for_each_scene_and_not_yet_drawn(driver: Driver, drawn: list[Any]) -> None:
    """Otherwise each turn would wait for a drawing, or the same one would be drawn again and again."""
    for turn in (1, 2, 3, 4):
        begin(driver, turn, 10 * turn)
    pictures: list[PictureToDraw] = driver.published('scene_image')
    assert [picture.stamp for picture in pictures] == [10, 20, 40]
    assert drawn == []
    shown = pictures[1].drawn()
    assert drawn == [[1]]
    assert (shown.picture.shape, shown.stamp, shown.frame_id) == ((2, 3, 3), 20, 'table')


def test_a_learner_of_another_world_sees_nothing(driver: Driver) -> None:
    """Otherwise its teacher would be asked about things that the teacher does not know."""
    begin(driver, 1, world={**WORLD, 'seed': 5})
    assert driver.refusals == [('turn', 'the learner has seed 5, this node 4')]
    assert driver.published('objects') == []
    begin(driver, 1, world=WORLD)
    assert len(driver.published('objects')) == 1
