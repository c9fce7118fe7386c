"""The world that every session is played in."""

from __future__ import annotations

import pytest

from al_questioner.simulation import PerceivedWorld, WorldChoice
from durable_sessions import TASK


@pytest.fixture(scope='session')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldChoice(TASK, 4, 4).open())
