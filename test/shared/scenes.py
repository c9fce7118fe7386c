"""Scenes of made-up features, and turns of an episode in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import Costs, Scene
from al_questioner.questioning import TurnContext


def make_scene(features: ArrayLike, object_ids: Sequence[int] | None, names: Sequence[str]) -> Scene:
    """A scene of things, numbered from 0 unless their ids are given, at no place in particular."""
    table = np.asarray(features, dtype=np.float32)
    ids = tuple(range(len(table))) if object_ids is None else tuple(object_ids)
    return Scene(ids, np.zeros((len(table), 3), dtype=np.float32), table, names)


def make_context(scene: Scene, concepts: ConceptLearner, **changes: object) -> TurnContext:
    """Turn 3 of 20."""
    values = {
        'turn': 3, 'turns': 20, 'scene': scene, 'concepts': concepts, 'budget': 20.0, 'spent': 2.0, 'costs': Costs(),
        'change_interval': 5, 'non_query_turns': 0, 'scene_turn': 1, 'history': (),
    }  # fmt: skip
    return TurnContext(**{**values, **changes})
