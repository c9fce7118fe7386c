"""Learners without ROS."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from al_questioner.domain import EpisodeSettings
from al_questioner.protocol.effects import Effect
from al_questioner.protocol.learner import LearnerOptions
from al_questioner.questioning import Picker
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.learner_robot import Robot
from shared.lunches import TASK, WORLD_SPEC

SETTINGS = episode_settings(TASK, 'farthest_fsq', 6.0, 8)


@pytest.fixture(scope='session')
def world() -> PerceivedWorld:
    return PerceivedWorld(WORLD_SPEC.open())


@pytest.fixture
def make(world: PerceivedWorld) -> Iterator[Callable[..., Robot]]:
    """Makes a learner that has begun, with these settings and options; all are closed after the test."""
    made: list[Robot] = []

    def make_robot(
        folder: Path | None = None,
        settings: EpisodeSettings = SETTINGS,
        pick: Picker | None = None,
        do: Callable[[Effect], None] = lambda _: None,
        **options: Any,
    ) -> Robot:
        robot = Robot(world, folder, settings, LearnerOptions(**options), pick, do)
        made.append(robot)
        robot.driver.start()
        return robot

    yield make_robot
    for robot in made:
        robot.machine.close()
