"""The world that every session is played in."""

from __future__ import annotations

import pytest

from al_questioner.simulation import PerceivedWorld, WorldSpec
from shared.durable_sessions import TASK


@pytest.fixture(scope='session')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())
