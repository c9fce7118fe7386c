"""Summary of a session's log, which was checked and played."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from al_questioner.domain import Answer, Knowledge, Query
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeEvent,
    EpisodeStarted,
    InputRejected,
    LateAnswerKept,
    SceneObserved,
    knowledge_of,
)
from al_questioner.event_log.log import LogContents, SessionLogError
from al_questioner.event_log.replay import ReplayError, replay_of
from al_questioner.questioning import Episode, Receipt


@dataclass(frozen=True)
class StatedAnswer:
    """Something that was said to a query.

    Attributes:
        stamp: when it was written down, nanoseconds since the epoch.
        answer: what was said.
        query: to which it was said; None if none of this id was asked.
        receipt: whether it counted or came too late.
        replaced_by: `answer_id` of the answer that replaced it; None if none did.
    """

    stamp: int
    answer: Answer
    query: Query | None
    receipt: Receipt
    replaced_by: str | None


@dataclass(frozen=True, eq=False)
class SessionSummary:
    """A session, up to where its log can be trusted.

    Attributes:
        events: with the time at which each was written, nanoseconds since the epoch.
        episode: as it is after these events.
        fault: what is wrong with the log, and where; None if it is whole.
    """

    folder: Path
    started: EpisodeStarted
    events: tuple[tuple[int, EpisodeEvent], ...]
    episode: Episode
    fault: str | None

    @property
    def turns_over(self) -> int:
        """Turns that are over: one that waits for an answer is not."""
        return self.episode.turns_over

    @property
    def observed(self) -> tuple[SceneObserved, ...]:
        """The scene of each turn that began."""
        by_turn = {event.turn: event for _, event in self.events if isinstance(event, SceneObserved)}
        return tuple(by_turn[turn] for turn in range(1, self.episode.turn + 1))

    @property
    def knowledge(self) -> Knowledge:
        """All that is known after these events.

        Raises:
            InputError: nothing was seen yet.
        """
        return knowledge_of(self.started, self.episode, {event.turn: event.stamp for event in self.observed})

    @property
    def queries(self) -> dict[str, Query]:
        """All that was asked, by `query_id`, in order."""
        decided = (event for _, event in self.events if isinstance(event, ActionChosen))
        return {decision.query.query_id: decision.query for decision in decided if decision.query is not None}

    @property
    def statements(self) -> list[StatedAnswer]:
        """All that was said to a query, in the order in which it was heard."""
        queries = self.queries
        told = [event.answer for _, event in self.events if isinstance(event, AnswerAccepted)]
        replaced = {(answer.query_id, answer.replaces): answer.answer_id for answer in told if answer.replaces}
        result = []
        for stamp, event in self.events:
            if isinstance(event, (AnswerAccepted, LateAnswerKept)):
                answer = event.answer
                receipt = Receipt.LATE if isinstance(event, LateAnswerKept) else Receipt.ACCEPTED
                replaced_by = replaced.get((answer.query_id, answer.answer_id))
                result.append(StatedAnswer(stamp, answer, queries.get(answer.query_id), receipt, replaced_by))
        return result

    @property
    def rejected(self) -> list[tuple[int, InputRejected]]:
        """The texts that were not taken for answers, with their times."""
        return [(stamp, event) for stamp, event in self.events if isinstance(event, InputRejected)]


def summarise_session(folder: Path, contents: LogContents) -> SessionSummary:
    """Play a log up to where it can be trusted.

    Raises:
        SessionLogError: not even the episode is known.
        SettingsError: its strategy is not installed.
    """
    events, fault = decoded(contents)
    started = events[0] if events else None
    if not isinstance(started, EpisodeStarted):
        raise SessionLogError(f'{folder}: nothing usable is in the session log ({fault or "no episode was begun"})')
    replay, played = replay_of(started), 1
    try:
        for event in events[1:]:
            replay.play(event)
            played += 1
    except ReplayError as error:
        fault = f'event {played + 1} does not follow from those before ({error})'
        # From the beginning, as the event may have had a part of its effect.
        replay = replay_of(started)
        for event in events[1:played]:
            replay.play(event)
    stamps = [event.stamp for event in contents.events]
    return SessionSummary(folder, started, tuple(zip(stamps, events[:played], strict=False)), replay.episode, fault)
