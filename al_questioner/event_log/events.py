"""The events of an episode, whether a session log tells of them or a bag."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from al_questioner.domain import Action, Answer, Decision, EpisodeSettings, Knowledge, Query, Scene, ViewTolerance
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.questioning import Episode
from al_questioner.questioning.semantics import SEMANTICS


@dataclass(frozen=True)
class EpisodeStarted:
    """The episode: all that determines what is asked, given scenes and answers.

    Attributes:
        seed: of the learner.
        view_tolerance: of the learner, see `questioning.Episode`.
        world: the simulated world, as `task`, `seed`, `sample` and `dataset`; None if it is another one.
        version: of this package; empty where it is not recorded.
        semantics: version of the method by which it decides.
    """

    episode_id: str
    settings: EpisodeSettings
    seed: int
    view_tolerance: ViewTolerance
    world: Document | None
    version: str
    semantics: int = SEMANTICS

    def members(self) -> Document:
        """Return the event as a JSON object."""
        members = dict(vars(self))
        settings = documents.settings_members(members.pop('settings'))
        return {'episode_id': members.pop('episode_id'), **settings, **members}


@dataclass(frozen=True, eq=False)
class SceneObserved:
    """The scene of a turn, as the learner took it; the stamp is that of the turn, in nanoseconds."""

    turn: int
    stamp: int
    frame_id: str
    scene: Scene


@dataclass(frozen=True)
class ActionChosen:
    """The choice of a turn.

    Attributes:
        query: the question; None if the action asks none, and in a bag, which need not hold it.
        weighed: the whole decision, without its query; None in a log, which does not hold it.
    """

    turn: int
    action: Action
    query: Query | None = None
    weighed: Decision | None = None


@dataclass(frozen=True)
class AnswerAccepted:
    """An answer that was accepted; a correction if it replaces another."""

    answer: Answer


@dataclass(frozen=True)
class LateAnswerKept:
    """An answer to a query that another answer had settled: kept, with its own query, and not learnt from."""

    answer: Answer
    reason: str


@dataclass(frozen=True)
class InputRejected:
    """A text that could not be taken for an answer, shortened if it is long; of a flood of them only the number."""

    text: str
    reason: str
    count: int = 1


@dataclass(frozen=True)
class KernelTuned:
    """The kernel was tuned at the end of a turn, as learners of earlier versions could.

    To what is not recorded: it follows from the labels. `model_version` is that after it, None in a bag.
    """

    turn: int
    model_version: int | None = None


@dataclass(frozen=True)
class TurnTimedOut:
    """A turn that was over although nobody had answered the query that waits.

    A bag tells only that the turn was over: there `query_id` is None, and it timed out if a query waited.
    """

    turn: int
    query_id: str | None = None


_Heard = AnswerAccepted | LateAnswerKept | InputRejected
EpisodeEvent = EpisodeStarted | SceneObserved | ActionChosen | _Heard | KernelTuned | TurnTimedOut

KINDS = {
    EpisodeStarted: 'episode',
    SceneObserved: 'scene',
    ActionChosen: 'decision',
    AnswerAccepted: 'answer',
    LateAnswerKept: 'late',
    InputRejected: 'refused',
    KernelTuned: 'tune',
    TurnTimedOut: 'passed',
}
"""The word for each event in a log; an answer that replaces another is a 'correction' there."""


def kind_of(event: EpisodeEvent) -> str:
    """Return the word for an event in a log."""
    if isinstance(event, AnswerAccepted) and event.answer.replaces is not None:
        return 'correction'
    return KINDS[type(event)]


def knowledge_of(started: EpisodeStarted, episode: Episode, stamps: Mapping[int, int]) -> Knowledge:
    """Return all that is known in an episode, given the stamps of its turns in nanoseconds.

    Raises:
        InputError: nothing was seen yet.
    """
    return episode.knowledge(started.episode_id, stamps, started.world, started.version)
