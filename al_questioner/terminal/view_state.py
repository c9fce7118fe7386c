"""What there is to show to a person at a terminal, at one moment."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Answer, Query, QueryRecord, Scene

Picture = NDArray[np.uint8]
"""(h, w, 3) red-green-blue."""


class Phase(Enum):
    """What the person and the robot are at."""

    ALONE = 'no robot has been heard'
    THINKING = 'the robot looks and thinks'
    ASKED = 'a question is open'
    CORRECTING = 'an earlier answer is being taken back'
    SENDING = 'an answer is on its way'
    OVER = 'the episode is over'


@dataclass(frozen=True)
class EpisodeProgress:
    """How far an episode is, as the learner tells it.

    Attributes:
        turn: the last one that is over.
        turns: of the episode.
        budget: of the episode.
        spent: of the budget.
        done: whether the episode is over.
        records: what came of each query.
        last: the answer that was taken last, whoever gave it, and its query.
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
    """A question, and what was on the table when it was asked."""

    query: Query
    scene: Scene | None
    picture: Picture | None


@dataclass(frozen=True, eq=False)
class PastAnswer:
    """An answer, and what it was the answer to."""

    prompt: Prompt
    answer: Answer


@dataclass(frozen=True, eq=False)
class ViewState:
    """All that there is to show at one moment.

    Attributes:
        phase: what is going on.
        prompt: the question that is shown, if any.
        corrected: the earlier answer that is being taken back, if any.
        progress: as last told by the learner; None before that.
        can_undo: whether there is an answer to take back.
        notice: what came of the last answer, or that nothing does.
        teacher_id: who answers.
    """

    phase: Phase
    prompt: Prompt | None = None
    corrected: PastAnswer | None = None
    progress: EpisodeProgress | None = None
    can_undo: bool = False
    notice: str = ''
    teacher_id: str = 'human'
