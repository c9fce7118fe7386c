"""Members of the documents `episode` and `learner_state`, and texts for a node's diagnostics."""

from __future__ import annotations

import dataclasses
import statistics
from collections.abc import Collection, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.event_log.events import EpisodeStarted
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.questioning import Episode


def episode_members(
    started: EpisodeStarted, feature_names: Sequence[str], tuned_turns: Collection[int] = ()
) -> Document:
    """Members of the `episode` document, once the features are known.

    The tuned turns are those at whose end an earlier version, with which the session was begun, tuned the kernel.
    """
    return {
        **documents.settings_members(started.settings),
        'feature_names': list(feature_names),
        'view_tolerance': started.view_tolerance,
        'seed': started.seed,
        'world': started.world,
        'semantics': started.semantics,
        **({'tuned_turns': sorted(tuned_turns)} if tuned_turns else {}),
    }


def state_members(episode: Episode, beliefs: NDArray[np.float64]) -> Document:
    """Members of the `learner_state` document: all up to the last turn that is over.

    Args:
        episode: after its first turn began.
        beliefs: (n, |Y|) q_y(x) of the scene of the present turn.
    """
    last, members_of = episode.answers.last, documents.members_of
    return {
        'turn': episode.turns_over,
        'turns': episode.settings.turns,
        'budget': episode.settings.budget,
        'spent': sum(record.cost for record in episode.records),
        'done': episode.done,
        'queries': [documents.record_members(record) for record in episode.records],
        'labels': dict(episode.positives),
        'model_version': episode.concepts.model_version,
        # Somebody who comes back may want to correct it.
        'last_answer': None if last is None else {'query': members_of(last[0]), 'answer': members_of(last[1])},
        'teachers': {name: dataclasses.asdict(record) for name, record in episode.teachers.items()},
        'kernel': dataclasses.asdict(episode.concepts.kernel),
        'beliefs': {
            str(object_id): dict(zip(episode.settings.symbols, (round(float(p), 6) for p in row), strict=True))
            for object_id, row in zip(episode.scene.object_ids, beliefs, strict=True)
        },
    }


def noise_text(noise: Mapping[str, float]) -> str:
    """Describe the sensors' noise, of each feature as share of its spread among things, for people."""
    if not noise:
        return 'not estimated'
    noisiest = max(noise, key=lambda name: noise[name])
    usual = statistics.median(noise.values())
    return f"{usual:.2g} of a feature's spread (median); the noisiest is {noisiest}: {noise[noisiest]:.2g}"
