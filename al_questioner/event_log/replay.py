"""Going through an episode's events again: the same scenes and answers lead to the same decisions."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable

import numpy as np

from al_questioner.domain import Decision, EpisodeError, InputError, Query, random_stream
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
from al_questioner.questioning import Episode, Human, Strategy, TurnContext, make_strategy
from al_questioner.questioning.semantics import SEMANTICS
from al_questioner.questioning.strategies.as_recorded import AsRecorded

_ANOTHER_VERSION = f'by version {{}} of the method, this is version {SEMANTICS}'

ROUNDING = 1e-5
"""Difference, absolute or relative, up to which numbers are equal.

A look-ahead is exact to 1e-6, and which error is left depends on the version and on the processor's last digits.
"""


class ReplayError(InputError):
    """Events that do not lead to the decisions that are recorded among them; the text says in which turn."""


class Replay:
    """Plays the events of an episode to an Episode, in the order in which they came about.

    The strategy decides again, but a person's choices are taken as recorded, and so are, unless `is_strict`, those of
    another version of the method.

    Attributes:
        episode: as it is after the events played so far.
        observed: the scene of the present turn; None before the first.
        decision: of the present turn; None before the first.
        stamps: of the turns so far, in nanoseconds.
    """

    def __init__(self, started: EpisodeStarted, strategy: Strategy, is_strict: bool = False) -> None:
        if started.semantics != SEMANTICS and not is_strict and not isinstance(strategy, Human):
            strategy = AsRecorded(strategy)
        rng = random_stream(started.seed, 'learner')
        self.episode = Episode(started.settings, rng, started.view_tolerance, strategy)
        self.observed: SceneObserved | None = None
        self.decision: Decision | None = None
        self.stamps: dict[int, int] = {}
        self._next_observed: SceneObserved | None = None

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

    def note_turn(self, observed: SceneObserved, decision: Decision) -> None:
        """Take note of a turn that the episode itself was asked for."""
        self.observed, self.decision = observed, decision
        self.stamps[observed.turn] = observed.stamp

    def _play(self, event: EpisodeEvent) -> None:
        if isinstance(event, EpisodeStarted):
            raise ReplayError('another episode begins within the log')
        if isinstance(event, SceneObserved):
            self._next_observed = event
        elif isinstance(event, ActionChosen):
            self._decide(event)
        elif isinstance(event, AnswerAccepted):
            self.episode.tell(event.answer)
        elif isinstance(event, LateAnswerKept):
            self.episode.keep_late(event.answer)
        elif isinstance(event, TurnTimedOut):
            self._time_out(event)
        elif isinstance(event, KernelTuned):
            self._repeat_tuning(event)

    def _decide(self, recorded: ActionChosen) -> None:
        observed, self._next_observed = self._next_observed, None
        if observed is None or observed.turn != self.episode.turn + 1 or recorded.turn != observed.turn:
            raise ReplayError(f'turn {recorded.turn}: the decision is not about the scene of the next turn')
        strategy = self.episode.strategy
        if isinstance(strategy, Human | AsRecorded):
            strategy.recorded = recorded.action
        decision = self.episode.ask(observed.scene)
        if isinstance(strategy, Human | AsRecorded):
            strategy.recorded = None
        found = _difference(decision, recorded)
        if found:
            raise ReplayError(f'turn {recorded.turn}: {found}')
        self.note_turn(observed, decision)

    def _time_out(self, recorded: TurnTimedOut) -> None:
        query = self.episode.awaited
        if query is None and recorded.query_id is None:
            return
        is_named = query is not None and recorded.query_id in (None, query.query_id)
        if not is_named or self.episode.turn != recorded.turn:
            raise ReplayError(f'turn {recorded.turn}: query {recorded.query_id} does not wait for an answer')
        self.episode.time_out()

    def _repeat_tuning(self, recorded: KernelTuned) -> None:
        self.episode.repeat_tuning()
        version = self.episode.concepts.model_version
        if self.episode.turn != recorded.turn or recorded.model_version not in (None, version):
            raise ReplayError(
                f'turn {self.episode.turn}: the models have version {version} after tuning,'
                f' recorded were version {recorded.model_version} and turn {recorded.turn}'
            )


def replay_of(started: EpisodeStarted, is_strict: bool = False) -> Replay:
    """Return the replay of an episode by the strategy that its settings name; see `Replay`.

    Raises:
        InputError: the strategy, or its weights, do not exist.
    """
    strategy = make_strategy(started.settings.strategy, started.settings.weights, _refuse_to_pick)
    return Replay(started, strategy, is_strict)


def _refuse_to_pick(context: TurnContext) -> int:
    raise EpisodeError('strategy human: only what is recorded is replayed, nobody is there to choose')


def first_divergence(started: EpisodeStarted, events: Iterable[EpisodeEvent]) -> str | None:
    """Play what follows the beginning of an episode, and compare every decision as far as it is recorded.

    Decisions are the same if they weigh the same candidates, choose the same one and, but for rounding, see the same
    features and utilities in them. What a person chose is taken as given.

    Returns:
        The turn of the first decision that is another one, and what is different, in words; None if all are the same.

    Raises:
        InputError: the strategy of the episode, or its weights, do not exist.
    """
    replay = replay_of(started, is_strict=True)
    of_another = f' ({_ANOTHER_VERSION.format(started.semantics)})' if started.semantics != SEMANTICS else ''
    for event in events:
        try:
            replay.play(event)
        except ReplayError as error:
            return f'{error}{of_another}'
        if isinstance(event, ActionChosen) and event.weighed is not None and replay.decision is not None:
            found = _difference_of_numbers(replay.decision, event.weighed)
            if found:
                return f'turn {event.turn}: {found}{of_another}'
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
