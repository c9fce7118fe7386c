"""Going through a log's events again: the same scenes and answers lead an episode to the same decisions."""

from __future__ import annotations

import dataclasses

from al_questioner.domain import Decision, InputError, Query, random_stream
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeStarted,
    KernelTuned,
    LateAnswerKept,
    SceneObserved,
    SessionEvent,
    TurnTimedOut,
    kind_of,
)
from al_questioner.questioning import Episode, ReplayedPicks, make_strategy


class ReplayError(InputError):
    """A log that does not lead to the decisions that are recorded in it; the text says where."""


class Replay:
    """Plays the events of a session to an Episode, in the order in which they came about.

    Args:
        begun: the episode.

    Attributes:
        episode: as it is after the events played so far.
        seen: the scene of the present turn; None before the first.
        decision: of the present turn; None before the first.

    Raises:
        InputError: the strategy, or its weights, do not exist.
    """

    def __init__(self, begun: EpisodeStarted) -> None:
        self._choices = ReplayedPicks()
        strategy = make_strategy(begun.settings.strategy, begun.settings.weights, self._choices)
        rng = random_stream(begun.seed, 'learner')
        self.episode = Episode(begun.settings, rng, begun.view_tolerance, strategy)
        self.seen: SceneObserved | None = None
        self.decision: Decision | None = None
        self._next_seen: SceneObserved | None = None

    def play(self, event: SessionEvent) -> None:
        """Play the next event.

        Raises:
            ReplayError: it does not follow from those before.
        """
        try:
            self._play(event)
        except ReplayError:
            raise
        except (InputError, RuntimeError) as error:
            raise ReplayError(f'turn {self.episode.turn}: {kind_of(event)}: {error}') from error

    def asked(self, seen: SceneObserved, decision: Decision) -> None:
        """Take note of what the episode was asked."""
        self.seen, self.decision = seen, decision

    def _play(self, event: SessionEvent) -> None:
        if isinstance(event, EpisodeStarted):
            raise ReplayError('another episode begins within the log')
        if isinstance(event, SceneObserved):
            self._next_seen = event
        elif isinstance(event, ActionChosen):
            self._decide(event)
        elif isinstance(event, AnswerAccepted):
            self.episode.tell(event.answer)
        elif isinstance(event, LateAnswerKept):
            self.episode.answers.keep_late(event.answer)
        elif isinstance(event, TurnTimedOut):
            self._pass(event)
        elif isinstance(event, KernelTuned):
            self._tune(event)

    def _decide(self, recorded: ActionChosen) -> None:
        seen, self._next_seen = self._next_seen, None
        if seen is None or seen.turn != self.episode.turn + 1 or recorded.turn != seen.turn:
            raise ReplayError(f'turn {recorded.turn}: the decision is not about the scene of the next turn')
        self._choices.action = recorded.action
        decision = self.episode.ask(seen.scene)
        self._choices.action = None
        action = decision.candidates[decision.chosen]
        if action != recorded.action:
            raise ReplayError(f'turn {recorded.turn}: {action} is chosen, {recorded.action} was recorded')
        if not _is_same_query(decision.query, recorded.query):
            raise ReplayError(f'turn {recorded.turn}: {decision.query} is asked, {recorded.query} was recorded')
        self.asked(seen, decision)

    def _pass(self, recorded: TurnTimedOut) -> None:
        query = self.episode.awaited
        if query is None or (self.episode.turn, query.query_id) != (recorded.turn, recorded.query_id):
            raise ReplayError(f'turn {recorded.turn}: query {recorded.query_id} does not wait for an answer')
        self.episode.time_out()

    def _tune(self, recorded: KernelTuned) -> None:
        self.episode.tune()
        version = self.episode.concepts.model_version
        if (self.episode.turn, version) != (recorded.turn, recorded.model_version):
            raise ReplayError(
                f'turn {self.episode.turn}: the models have version {version} after tuning,'
                f' recorded were version {recorded.model_version} and turn {recorded.turn}'
            )


def _is_same_query(query: Query | None, recorded: Query | None) -> bool:
    """Whether they ask the same; logs of earlier versions do not tell which things were known."""
    if query is not None and recorded is not None and recorded.known is None:
        query = dataclasses.replace(query, known=None)
    return query == recorded
