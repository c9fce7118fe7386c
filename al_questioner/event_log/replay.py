"""Going through an episode's events again: the same scenes and answers lead to the same decisions."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np

from al_questioner.domain import Decision, InputError, Query, random_stream
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeEvent,
    EpisodeStarted,
    KernelTuned,
    LateAnswerKept,
    SceneObserved,
    TurnTimedOut,
    kind_of,
)
from al_questioner.questioning import Episode, ReplayedPicks, Strategy, make_strategy

ROUNDING = 1e-8
"""Difference, absolute or relative, up to which numbers are equal: processors differ in their last digits."""


class ReplayError(InputError):
    """Events that do not lead to the decisions that are recorded among them; the text says in which turn."""


class Replay:
    """Plays the events of an episode to an Episode, in the order in which they came about.

    If no strategy is given, that of the settings decides, with a person's choices as recorded.

    Attributes:
        episode: as it is after the events played so far.
        seen: the scene of the present turn; None before the first.
        decision: of the present turn; None before the first.

    Raises:
        InputError: the strategy, or its weights, do not exist.
    """

    def __init__(self, begun: EpisodeStarted, strategy: Strategy | None = None) -> None:
        self._picks = ReplayedPicks()
        if strategy is None:
            strategy = make_strategy(begun.settings.strategy, begun.settings.weights, self._picks)
        rng = random_stream(begun.seed, 'learner')
        self.episode = Episode(begun.settings, rng, begun.view_tolerance, strategy)
        self.seen: SceneObserved | None = None
        self.decision: Decision | None = None
        self._next_seen: SceneObserved | None = None

    def play(self, event: EpisodeEvent) -> None:
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

    def _play(self, event: EpisodeEvent) -> None:
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
            self._time_out(event)
        elif isinstance(event, KernelTuned):
            self._tune(event)

    def _decide(self, recorded: ActionChosen) -> None:
        seen, self._next_seen = self._next_seen, None
        if seen is None or seen.turn != self.episode.turn + 1 or recorded.turn != seen.turn:
            raise ReplayError(f'turn {recorded.turn}: the decision is not about the scene of the next turn')
        self._picks.action = recorded.action
        decision = self.episode.ask(seen.scene)
        self._picks.action = None
        found = _difference(decision, recorded)
        if found:
            raise ReplayError(f'turn {recorded.turn}: {found}')
        self.asked(seen, decision)

    def _time_out(self, recorded: TurnTimedOut) -> None:
        query = self.episode.awaited
        if query is None and recorded.query_id is None:
            return
        is_named = query is not None and recorded.query_id in (None, query.query_id)
        if not is_named or self.episode.turn != recorded.turn:
            raise ReplayError(f'turn {recorded.turn}: query {recorded.query_id} does not wait for an answer')
        self.episode.time_out()

    def _tune(self, recorded: KernelTuned) -> None:
        self.episode.tune()
        version = self.episode.concepts.model_version
        if self.episode.turn != recorded.turn or recorded.model_version not in (None, version):
            raise ReplayError(
                f'turn {self.episode.turn}: the models have version {version} after tuning,'
                f' recorded were version {recorded.model_version} and turn {recorded.turn}'
            )


def first_divergence(begun: EpisodeStarted, events: Iterable[EpisodeEvent]) -> str | None:
    """Play what follows the beginning of an episode, and compare every decision as far as it is recorded.

    Decisions are the same if they weigh the same candidates, choose the same one and, but for rounding, see the same
    features and utilities in them. What a person chose is taken as given.

    Returns:
        The turn of the first decision that is another one, and what is different, in words; None if all are the same.

    Raises:
        InputError: the strategy of the episode, or its weights, do not exist.
    """
    replay = Replay(begun)
    for event in events:
        try:
            replay.play(event)
        except ReplayError as error:
            return str(error)
        if isinstance(event, ActionChosen) and event.weighed is not None and replay.decision is not None:
            found = _difference_of_numbers(replay.decision, event.weighed)
            if found:
                return f'turn {event.turn}: {found}'
    return None


def _difference(decision: Decision, recorded: ActionChosen) -> str:
    """Return in what a decision is not the recorded one, numbers aside; empty if in nothing."""
    action, weighed = decision.candidates[decision.chosen], recorded.weighed
    if weighed is not None and decision.candidates != weighed.candidates:
        return f'{len(decision.candidates)} candidates, {len(weighed.candidates)} recorded'
    if action != recorded.action:
        return f'{action} is chosen, {recorded.action} was recorded'
    if weighed is None and not _is_same_query(decision.query, recorded.query):
        return f'{decision.query} is asked, {recorded.query} was recorded'
    return ''


def _difference_of_numbers(decision: Decision, recorded: Decision) -> str:
    """Return in which numbers a decision is not the recorded one; empty if it is the same but for rounding."""
    for name in ('features', 'utilities'):
        ours, theirs = getattr(decision, name), getattr(recorded, name)
        if not np.array_equal(np.isnan(ours), np.isnan(theirs)):
            return f'the {name} of other candidates are missing'
        if not np.allclose(ours, theirs, rtol=ROUNDING, atol=ROUNDING, equal_nan=True):
            return f'the {name} differ by up to {np.nanmax(np.abs(ours - theirs)):.3g}'
    return ''


def _is_same_query(query: Query | None, recorded: Query | None) -> bool:
    """Return whether they ask the same; logs of earlier versions do not tell which things were known."""
    if query is not None and recorded is not None and recorded.known is None:
        query = dataclasses.replace(query, known=None)
    return query == recorded
