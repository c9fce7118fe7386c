"""Going through a log's events again: the same scenes and answers lead an episode to the same decisions."""

from __future__ import annotations

import dataclasses

from al_questioner.domain import Answer, Decision, InputError, Query, generator
from al_questioner.event_log.events import Begun, Decided, KeptLate, Passed, Seen, SessionEvent, Told, Tuned
from al_questioner.questioning import Episode, Human, Remembered


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

    def __init__(self, begun: Begun) -> None:
        self._choices = Remembered()
        strategy = Human(self._choices) if begun.settings.strategy == 'human' else None
        rng = generator(begun.seed, 'learner')
        self.episode = Episode(begun.settings, rng, begun.view_tolerance, strategy)
        self.seen: Seen | None = None
        self.decision: Decision | None = None
        self._next_seen: Seen | None = None

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
            raise ReplayError(f'turn {self.episode.turn}: {type(event).__name__.lower()}: {error}') from error

    def asked(self, seen: Seen, decision: Decision) -> None:
        """Take note of what the episode was asked."""
        self.seen, self.decision = seen, decision

    def _play(self, event: SessionEvent) -> None:
        if isinstance(event, Begun):
            raise ReplayError('another episode begins within the log')
        if isinstance(event, Seen):
            self._next_seen = event
        elif isinstance(event, Decided):
            self._decide(event)
        elif isinstance(event, Told):
            learn(self.episode, event.answer)
        elif isinstance(event, KeptLate):
            self.episode.answers.keep_late(event.answer)
        elif isinstance(event, Passed):
            self._pass(event)
        elif isinstance(event, Tuned):
            self._tune(event)

    def _decide(self, recorded: Decided) -> None:
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

    def _pass(self, recorded: Passed) -> None:
        query = self.episode.awaited
        if query is None or (self.episode.turn, query.query_id) != (recorded.turn, recorded.query_id):
            raise ReplayError(f'turn {recorded.turn}: query {recorded.query_id} does not wait for an answer')
        self.episode.let_pass()

    def _tune(self, recorded: Tuned) -> None:
        self.episode.tune()
        version = self.episode.knowledge.model_version
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


def learn(episode: Episode, answer: Answer) -> None:
    """Tell an episode an answer, or amend it by one that replaces another.

    Raises:
        AnswerError: it is refused.
    """
    if answer.replaces is None:
        episode.tell(answer)
    else:
        episode.amend(answer)
