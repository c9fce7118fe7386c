"""An episode whose log is the truth: written before anybody hears of it, and replayed to go on after a crash."""

from __future__ import annotations

import contextlib
from collections.abc import Collection

from al_questioner.domain import AUTO, CARRY_LABELS, Answer, Decision, InputError, Knowledge
from al_questioner.event_log.encoding import Encoder, decoded
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeEvent,
    EpisodeStarted,
    InputRejected,
    LateAnswerKept,
    SceneObserved,
    TurnTimedOut,
    knowledge_of,
)
from al_questioner.event_log.log import LogContents, LogWriteError, SessionLog, SessionLogError
from al_questioner.event_log.replay import Replay
from al_questioner.questioning import Episode, PreparedAnswer, Receipt, Strategy
from al_questioner.support.differences import differences
from al_questioner.support.rate_limiter import RateLimiter

NOT_SETTINGS = frozenset({'version', 'semantics', 'concepts', 'concepts_sha256'})
"""Members of an episode's first event that a learner that goes on with it need not share.

Whether what was known before is the same is looked at apart.
"""
NEW_DEFAULTS = frozenset({'kernel_shape', 'class_balance', 'costs.relevance'})
"""Members whose defaults are not those of the earlier version of the method, in which they could not be set."""
REJECTED_KEPT, REJECTED_PERIOD = 10, 60.0
"""Number of texts that were no answers and are kept word for word in a period; of a flood the rest is counted."""


class DurableEpisode:
    """An Episode whose events are all on the disk before their effects are known to anybody.

    Without a log it is the Episode alone. An empty `episode_id` stands for the episode that the log has.

    Attributes:
        started: the episode, as the log has it if there is one already.

    Raises:
        SessionLogError: the log is of an episode with other settings, which the text names, or it cannot be understood.
        InputError: what is known already comes from an episode of the same id.
    """

    def __init__(self, wanted: EpisodeStarted, strategy: Strategy, log: SessionLog | None = None) -> None:
        self._strategy = strategy
        self._log = log
        self._encoder = Encoder()
        self._events: list[EpisodeEvent] = []
        self._replay: Replay | None = None
        self._last_rejected: InputRejected | None = None
        self._limiter = RateLimiter(REJECTED_KEPT, REJECTED_PERIOD)
        self._only_counted = 0
        self.started = wanted
        if log is not None and log.events:
            self._events, damage = decoded(LogContents(log.events, None))
            if damage is not None:
                raise SessionLogError(f'{log.folder}: {damage}')
            self.started = _same_episode(log, self._events[0], wanted)
        known = self.started.settings.concepts
        if known is not None and self.started.episode_id in {origin.episode for origin in known.origins}:
            raise InputError(
                f'what is known comes from an episode {self.started.episode_id!r} already: give this one another'
            )

    @property
    def is_ready(self) -> bool:
        """True once `start` has ended."""
        return self._replay is not None

    @property
    def episode(self) -> Episode:
        """The episode itself, to look at."""
        return self._running.episode

    @property
    def observed(self) -> SceneObserved | None:
        """The scene of the present turn; None before the first."""
        return self._running.observed

    @property
    def decision(self) -> Decision | None:
        """The decision of the present turn; None before the first."""
        return self._running.decision

    @property
    def stamps(self) -> Collection[int]:
        """Stamps of the turns so far, in their order, in nanoseconds."""
        return self._running.stamps.values()

    def knowledge(self) -> Knowledge:
        """Return all that is known now, to keep it.

        Raises:
            InputError: nothing was seen yet.
        """
        return knowledge_of(self.started, self.episode, self._running.stamps)

    def start(self) -> None:
        """Begin, or play all of the log to continue where it ends.

        Raises:
            ReplayError: the log does not lead to the decisions in it.
            LogWriteError: the log of a new episode cannot be written.
        """
        replay = Replay(self.started, self._strategy)
        if not self._events:
            self._write(self.started)
        for event in self._events[1:]:
            replay.play(event)
            self._encoder.follow(event)
        self._events = []
        self._replay = replay

    def ask(self, observed: SceneObserved) -> Decision:
        """See `Episode.ask`.

        Raises:
            SceneError: the scene is refused.
            LogWriteError: scene and decision cannot be written; the episode cannot go on.
        """
        decision = self.episode.ask(observed.scene)
        self._write(observed, ActionChosen(decision.turn, decision.candidates[decision.chosen], decision.query))
        self._running.note_turn(observed, decision)
        return decision

    def take(self, answer: Answer) -> PreparedAnswer:
        """See `Episode.take`.

        Raises:
            AnswerError: it is invalid.
            LogWriteError: it cannot be written, and is not taken.
        """
        prepared = self.episode.prepare(answer)
        if prepared.is_kept:
            is_late = prepared.receipt is Receipt.LATE
            self._write(LateAnswerKept(answer, prepared.reason) if is_late else AnswerAccepted(answer))
            self.episode.commit(prepared)
        return prepared

    def note_rejected(self, text: str, reason: str, now: float) -> None:
        """Keep a text that was not taken for an answer, once if it is repeated; of a flood of them, keep the number.

        Args:
            text: what was heard.
            reason: why it was not taken.
            now: time of a steady clock, in seconds.

        Raises:
            LogWriteError: it cannot be written.
        """
        rejected = InputRejected(text, reason)
        if rejected == self._last_rejected:
            return
        self._last_rejected = rejected
        if self._limiter.passes(now):
            self._note_counted()
            self._write(rejected)
        else:
            self._only_counted += 1

    def _note_counted(self) -> None:
        """Write down how many rejected texts were counted only."""
        count, self._only_counted = self._only_counted, 0
        if count:
            self._write(InputRejected('', f'{count} more, too many to keep', count))

    def time_out(self) -> None:
        """See `Episode.time_out`.

        Raises:
            LogWriteError: it cannot be written, and the turn is not over.
        """
        query = self.episode.awaited
        if query is None:
            raise RuntimeError('no query waits for its answer')
        self._write(TurnTimedOut(self.episode.turn, query.query_id))
        self.episode.time_out()

    def close(self) -> None:
        """Close the log."""
        if self._log is not None:
            with contextlib.suppress(LogWriteError):
                self._note_counted()
            self._log.close()

    @property
    def _running(self) -> Replay:
        if self._replay is None:
            raise RuntimeError('the episode has not been started')
        return self._replay

    def _write(self, *events: EpisodeEvent) -> None:
        if self._log is not None:
            self._log.append(*map(self._encoder.encode, events))


def _same_episode(log: SessionLog, first: EpisodeEvent, wanted: EpisodeStarted) -> EpisodeStarted:
    """Return the episode that a log begins with, if it is the one that is wanted."""
    if not isinstance(first, EpisodeStarted):
        raise SessionLogError(f'{log.folder}: its first event is not the beginning of an episode')
    ignored = NOT_SETTINGS if wanted.episode_id else NOT_SETTINGS | {'episode_id'}
    if wanted.view_tolerance == AUTO:
        # Older logs have the number that was the default then, and keep it.
        ignored |= {'view_tolerance'}
    if not _is_known(first.settings.concepts, wanted.settings.concepts):
        raise SessionLogError(
            f'{log.folder}: the session there began with other concepts; a new episode needs a folder of its own'
        )
    if first.semantics != wanted.semantics:
        # Defaults and weights were others, too; the episode keeps the classifiers that it began with.
        weights = {*first.settings.weights, *wanted.settings.weights}
        ignored |= NEW_DEFAULTS | {f'weights.{name}' for name in weights}
    theirs, ours = ({CARRY_LABELS.name: False, **each.members()} for each in (first, wanted))
    differing = differences(theirs, ours, ignored)
    if differing:
        has = '; '.join(differing)
        raise SessionLogError(f'{log.folder}: the session there has {has}; a new episode needs a folder of its own')
    return first


def _is_known(recorded: Knowledge | None, given: Knowledge | None) -> bool:
    """Return whether what is given says no other than what an episode began with, as its log has it.

    The file may be gone by now, or the episode may itself have added to it.
    """
    if given is None or recorded is None:
        return given is None
    return given.lessons[: len(recorded.lessons)] == recorded.lessons
