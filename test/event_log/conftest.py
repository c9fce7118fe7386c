"""The world that every session is played in."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from al_questioner.questioning import Picker
from al_questioner.simulation import PerceivedWorld, WorldSpec
from shared.durable_sessions import TASK, Start, start_durable


@pytest.fixture(scope='session')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Start]:
    """Starts the session in the folder of the test, and ends the one that it started before."""
    running = []

    def end() -> None:
        while running:
            running.pop().close()

    def start_again(pick: Picker | None = None, **changes: object) -> object:
        end()
        running.append(start_durable(tmp_path, pick, **changes))
        return running[0]

    yield start_again
    end()
