"""All that is shown at one moment to a person who teaches."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Answer, Query, QueryRecord, Scene

Picture = NDArray[np.uint8]
"""An (h, w, 3) red-green-blue picture."""


class Phase(Enum):
    """Phase of the dialogue between person and robot."""

    ALONE = 'no robot has been heard'
    THINKING = 'the robot looks and thinks'
    ASKED = 'a question is open'
    CORRECTING = 'an earlier answer is being taken back'
    SENDING = 'an answer is on its way'
    OVER = 'the episode is over'


@dataclass(frozen=True)
class EpisodeProgress:
    """Progress of an episode, as the learner reports it.

    Attributes:
        turn: the last turn that is over.
        turns: turns of the episode.
        budget: budget of the episode.
        spent: part of the budget that was spent.
        done: whether the episode is over.
        records: the result of each query.
        last: the answer that was accepted last, from any teacher, and its query.
    """

    turn: int
    turns: int
    budget: float
    spent: float
    done: bool
    records: tuple[QueryRecord, ...] = ()
    last: tuple[Query, Answer] | None = None


@dataclass(frozen=True, eq=False)
class Prompt:
    """A question, and the scene at the time of it."""

    query: Query
    scene: Scene | None
    picture: Picture | None


@dataclass(frozen=True, eq=False)
class PastAnswer:
    """An answer and its question."""

    prompt: Prompt
    answer: Answer


@dataclass(frozen=True, eq=False)
class ViewState:
    """All that is shown at one moment.

    Attributes:
        phase: phase of the dialogue.
        prompt: the question that is shown, if any.
        corrected: the earlier answer that is being taken back, if any.
        progress: the learner's last report; None before the first.
        can_undo: whether there is an answer to take back.
        notice: the result of the last answer, or a warning that none comes.
        teacher_id: id of the person.
    """

    phase: Phase
    prompt: Prompt | None = None
    corrected: PastAnswer | None = None
    progress: EpisodeProgress | None = None
    can_undo: bool = False
    notice: str = ''
    teacher_id: str = 'human'
