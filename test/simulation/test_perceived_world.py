"""A world as feature vectors, each of which is measured once."""

from __future__ import annotations

from unittest.mock import Mock

import pytest

from al_questioner.perception import perceive, view_features
from al_questioner.simulation import PerceivedWorld
from shared.lunches import WORLD_SPEC


def test_scene_that_stays_is_perceived_once() -> None:
    """Otherwise every turn would cost a perception of the whole table."""
    world = PerceivedWorld(WORLD_SPEC.open())
    change = world.change_turns(40)[0]
    assert world.scene(1) is world.scene(change - 1)
    assert world.scene(change) is not world.scene(1)
    assert world.scene(1).features.tobytes() == perceive(world.observations(1)).features.tobytes()


def test_view_that_comes_back_is_measured_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Scenes draw on a pool: half of what a long episode measures it has measured before."""
    counting = Mock(wraps=view_features)
    monkeypatch.setattr('al_questioner.simulation.perceived_world.view_features', counting)
    world = PerceivedWorld(WORLD_SPEC.open())
    turns = [1, *world.change_turns(150)]
    seen = [observation.view for turn in turns for observation in world.observations(turn)]
    for turn in turns:
        world.scene(turn)
    assert counting.call_count == len(set(seen)) < len(seen)
