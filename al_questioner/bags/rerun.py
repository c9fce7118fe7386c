"""Playing a recorded session once more: whether the same scenes and answers give the same decisions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain

import numpy as np

from al_questioner.bags.episodes import RecordedEpisode, RecordedTurn
from al_questioner.domain import (
    NO_SYMBOL,
    Answer,
    Content,
    Decision,
    InputError,
    Outcome,
    QueryKind,
    QueryRecord,
    random_stream,
)
from al_questioner.questioning import (
    Choice,
    Episode,
    FeatureRecorder,
    FeatureSet,
    ReplayedPicks,
    Strategy,
    TurnContext,
    make_strategy,
)

ROUNDING = 1e-8
"""Difference, absolute or relative, up to which numbers are equal: processors differ in their last digits."""


@dataclass(frozen=True)
class Divergence:
    """The first decision that is another one.

    Attributes:
        turn: in which it was made.
        what: is different, in words.
    """

    turn: int
    what: str


def first_divergence(session: RecordedEpisode) -> Divergence | None:
    """Play the scenes and answers of a session to a learner with its settings, and compare every decision.

    Decisions are the same if they weigh the same candidates, choose the same one and, but for rounding, see the same
    features and utilities in them. What a person chose is taken as given.

    Raises:
        InputError: the strategy of the session, or its weights, do not exist.
    """
    choices = ReplayedPicks()
    strategy = make_strategy(session.settings.strategy, session.settings.weights, choices)
    episode = Episode(session.settings, random_stream(session.seed, 'learner'), session.view_tolerance, strategy)
    for recorded in chain(_turns(session, episode), [session.begun] if session.begun else []):
        choices.action = recorded.decision.candidates[recorded.decision.chosen]
        decision = episode.ask(recorded.scene)
        theirs = recorded.decision
        if decision.candidates != theirs.candidates:
            return Divergence(
                recorded.turn, f'{len(decision.candidates)} candidates, {len(theirs.candidates)} recorded'
            )
        if decision.chosen != theirs.chosen:
            chosen = [d.candidates[d.chosen] for d in (decision, theirs)]
            return Divergence(recorded.turn, f'{chosen[0]} is chosen, {chosen[1]} was recorded')
        for name, ours, other in (
            ('features', decision.features, theirs.features),
            ('utilities', decision.utilities, theirs.utilities),
        ):
            if not np.array_equal(np.isnan(ours), np.isnan(other)):
                return Divergence(recorded.turn, f'the {name} of other candidates are missing')
            if not np.allclose(ours, other, rtol=ROUNDING, atol=ROUNDING, equal_nan=True):
                return Divergence(recorded.turn, f'the {name} differ by up to {np.nanmax(np.abs(ours - other)):.3g}')
    return None


class _Follower:
    """Chooses what was chosen then."""

    selector = None

    def __init__(self) -> None:
        self.decision: Decision | None = None

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        if self.decision is None or self.decision.candidates != context.candidates:
            raise InputError(f'turn {context.turn}: other candidates than the settings and scenes make were recorded')
        return Choice(self.decision.chosen, self.decision.utilities)


def decisions_anew(session: RecordedEpisode, feature_set: FeatureSet) -> Iterator[Decision]:
    """The decisions of a session as they were made, but with features that were not recorded.

    Raises:
        InputError: the recorded candidates are not those that the session's scenes and settings make.
    """
    follower = _Follower()
    strategy: Strategy = FeatureRecorder(follower, feature_set)
    episode = Episode(session.settings, random_stream(session.seed, 'learner'), session.view_tolerance, strategy)
    for recorded in _turns(session, episode):
        follower.decision = recorded.decision
        yield episode.ask(recorded.scene)


def _turns(session: RecordedEpisode, episode: Episode) -> Iterator[RecordedTurn]:
    """Each turn, to ask the episode about its scene; then the episode is told what was said, and the turn is ended."""
    queries: dict[int, str] = {}
    answers: dict[int, Answer] = {}
    for recorded in session.turns:
        yield recorded
        if episode.pending is not None:
            queries[episode.pending.turn] = episode.pending.query_id
        for record in (record for record in recorded.told if record.turn in queries):
            corrected = answers.get(record.turn)
            answers[record.turn] = answer = _answer(record, queries[record.turn], corrected)
            episode.tell(answer)
        if episode.awaits_answer:
            episode.time_out()
        episode.tune()


def _answer(record: QueryRecord, query_id: str, corrected: Answer | None) -> Answer:
    """What was said, given the answer to the same query that it corrects, if any."""
    replaces = None if corrected is None else corrected.answer_id
    answer_id = 'recorded' if replaces is None else f'not {replaces}'
    return Answer(query_id, answer_id, 'recorded', record.outcome, _content(record), replaces)


def _content(record: QueryRecord) -> Content:
    if record.outcome is not Outcome.ANSWERED:
        return None
    if record.kind is QueryKind.LABEL:
        return record.symbol
    if record.kind is QueryKind.DEMONSTRATION:
        return NO_SYMBOL if record.object_id is None else record.object_id
    return record.groups
