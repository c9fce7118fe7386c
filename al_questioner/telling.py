"""What the documents `episode` and `learner_state` tell of an episode."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Scene
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.questioning import Episode
from al_questioner.recording.session_events import Begun


def episode_members(begun: Begun, feature_names: Sequence[str]) -> Document:
    """Members of the `episode` document, once the features are known."""
    return {
        **documents.settings_members(begun.settings),
        'feature_names': list(feature_names),
        'view_tolerance': begun.view_tolerance,
        'seed': begun.seed,
        'world': begun.world,
    }


def state_members(episode: Episode, scene: Scene, beliefs: NDArray[np.float64]) -> Document:
    """Members of the `learner_state` document: all up to the last turn that is over.

    Args:
        episode: after its first turn began.
        scene: of the present turn, n objects.
        beliefs: (n, |Y|) q_y(x) of it.
    """
    return {
        'turn': episode.turns_over,
        'turns': episode.settings.turns,
        'budget': episode.settings.budget,
        'spent': sum(record.cost for record in episode.records),
        'done': episode.done,
        'queries': [documents.record_members(record) for record in episode.records],
        'labels': dict(episode.positives),
        'model_version': episode.knowledge.model_version,
        'last_answer': _last_answer(episode),
        'teachers': {name: dataclasses.asdict(record) for name, record in episode.teachers.items()},
        'kernel': dataclasses.asdict(episode.knowledge.kernel),
        'beliefs': {
            str(object_id): {
                symbol: round(float(p), 6) for symbol, p in zip(episode.settings.symbols, row, strict=True)
            }
            for object_id, row in zip(scene.object_ids, beliefs, strict=True)
        },
    }


def _last_answer(episode: Episode) -> Document | None:
    """What somebody who comes back may want to take back."""
    if episode.answers.last is None:
        return None
    query, answer = episode.answers.last
    return {'query': documents.query_members(query), 'answer': documents.answer_members(answer)}
