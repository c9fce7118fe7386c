"""The events of a recorded episode, in the types in which a session log has them.

A bag tells less than a log. `learner_state` says what came of each query, and in which turn; it does not say who
answered under which id, whether a turn without an answer timed out or needed none, or which version the models had
after they were tuned. So the answers have `NOT_RECORDED` for their teacher and a number behind it for their id,
`TurnTimedOut` names no query, `KernelTuned` no version, and a query has the id of its number in the episode.
"""

from __future__ import annotations

import contextlib
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from al_questioner.bags.reading import BagError, deserialize
from al_questioner.bags.recorded_episode import RecordedEpisode
from al_questioner.bags.runs import Placed, Recorded, Run
from al_questioner.domain import NO_SYMBOL, Answer, Content, InputError, Outcome, QueryKind, QueryRecord, SceneError
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeEvent,
    EpisodeStarted,
    KernelTuned,
    SceneObserved,
    TurnTimedOut,
)
from al_questioner.messages import documents
from al_questioner.messages.clouds import decision_of_cloud, scene_of_cloud
from al_questioner.messages.documents import Document
from al_questioner.questioning.query_status import query_id
from al_questioner.questioning.semantics import EARLIEST_SEMANTICS

NOT_RECORDED = 'not recorded'
"""The teacher of an answer of which a bag holds only what came of it."""
EARLIER_VIEW_TOLERANCE = 1e-3
"""View tolerance of learners whose `episode` documents do not tell it."""


def decode_run(source: Path, recorded: Recorded, run: Run, document: Document) -> RecordedEpisode:
    """Return the episode of a run in a bag, given its `episode` document.

    Raises:
        InputError: it cannot be used; the text does not name the bag.
    """
    started = EpisodeStarted(
        episode_id=run.episode_id,
        settings=documents.settings_of(document),
        seed=document['seed'],
        view_tolerance=document.get('view_tolerance', EARLIER_VIEW_TOLERANCE),
        world=document['world'],
        version='',
        semantics=document.get('semantics', EARLIEST_SEMANTICS),
    )
    states = _states(recorded, run)
    last = states[-1].document['turn'] if states else 0
    if run.episode_id in recorded.corrected:
        missing = set(range(1, last)).difference(state.document['turn'] for state in states)
        if missing:
            without = f'turn {min(missing)} was recorded without its learner_state'
            raise InputError(f'{without}: what was known then cannot be said, as an answer was corrected')
    records, told = _course(states)
    tuned_turns = document.get('tuned_turns') or _multiples(document.get('tune_every', 0), last)
    decoder = _Decoder(recorded, run, started, tuple(document['feature_names']), tuned_turns)
    events: list[EpisodeEvent] = []
    for turn in range(1, last + 1):
        events += (*decoder.decided(turn), *decoder.ended(turn, told[turn]))
    if not events:
        raise InputError(f'the recording ended before the first turn of episode {run.episode_id} did{recorded.hint()}')
    with contextlib.suppress(InputError):
        events += decoder.decided(last + 1)
    of_turns = tuple(records[turn] for turn in sorted(records) if turn <= last)
    return RecordedEpisode(source, started, decoder.feature_names, tuple(events), last, of_turns)


class _Decoder:
    """Turns the messages of a run into events, turn by turn."""

    def __init__(
        self,
        recorded: Recorded,
        run: Run,
        started: EpisodeStarted,
        feature_names: tuple[str, ...],
        tuned_turns: Collection[int],
    ) -> None:
        self.feature_names = feature_names
        self._tuned_turns = tuned_turns
        self._recorded, self._run, self._settings = recorded, run, started.settings
        self._query_ids: dict[int, str] = {}
        self._answers: dict[int, int] = {}

    def decided(self, turn: int) -> tuple[SceneObserved, ActionChosen]:
        """Return what was seen and chosen in a turn.

        Raises:
            InputError: it was not recorded.
        """
        begin, of_turns = self._run.begins.get(turn), f'turn {turn} of {self._settings.turns}'
        if begin is None:
            late = 'did the recording begin too late?'
            raise InputError(f'{of_turns} was not recorded: {late}{self._recorded.hint()}')
        observed = self._observed(turn, begin)
        decision = self._recorded.decision(begin)
        if observed is None or decision is None:
            missing = 'objects' if observed is None else 'decision'
            # A learner that is killed and resumed may leave such a gap: its session has what no message told.
            raise InputError(
                f'{of_turns} was recorded without its {missing}{self._recorded.hint()};'
                ' if the learner kept a session, `session DIR --bag NEW_BAG` writes a whole bag'
            )
        weighed = decision_of_cloud(deserialize(decision.message), self._settings.symbols, turn)
        action = weighed.candidates[weighed.chosen]
        if action.kind is not QueryKind.NO_QUERY:
            self._query_ids[turn] = query_id(len(self._query_ids) + 1)
        return observed, ActionChosen(turn, action, weighed=weighed)

    def ended(self, turn: int, told: Sequence[QueryRecord]) -> Iterator[EpisodeEvent]:
        """Yield what was answered in a turn that was decided, and how it ended."""
        for record in (record for record in told if record.turn in self._query_ids):
            yield AnswerAccepted(self._answer(record))
        if self._query_ids and max(self._query_ids) not in self._answers:
            yield TurnTimedOut(turn)
        if turn in self._tuned_turns:
            yield KernelTuned(turn)

    def _answer(self, record: QueryRecord) -> Answer:
        """Return what must have been said; of a query that was answered before, it replaces that answer."""
        before = self._answers.get(record.turn, 0)
        self._answers[record.turn] = before + 1
        return Answer(
            query_id=self._query_ids[record.turn],
            answer_id=f'{NOT_RECORDED} {before + 1}',
            teacher_id=NOT_RECORDED,
            outcome=record.outcome,
            content=_content(record),
            replaces=f'{NOT_RECORDED} {before}' if before else None,
        )

    def _observed(self, turn: int, begin: Placed) -> SceneObserved | None:
        """Return the first cloud that a learner takes, None if there is no cloud; another node's it passes over.

        Raises:
            InputError: there are clouds, and it takes none of them.
        """
        reasons: list[str] = []
        for placed in self._recorded.clouds(self._run, turn):
            try:
                cloud = deserialize(placed.message)
                scene = scene_of_cloud(cloud, self.feature_names)
            except (SceneError, BagError) as error:
                reasons.append(f'turn {turn}: {error}')
                continue
            if scene.feature_names == self.feature_names:
                return SceneObserved(turn, begin.stamp, cloud.header.frame_id, scene)
            counts = f'{len(scene.feature_names)}, announced {len(self.feature_names)}'
            reasons.append(f'the objects of turn {turn} have other features than the episode announces ({counts})')
        if reasons:
            raise InputError(reasons[0])
        return None


class _State(NamedTuple):
    """Published state of a learner.

    Attributes:
        document: which tells, as `turn`, how many turns were over.
        decided: the turn whose decision had been made.
    """

    document: Document
    decided: int


def _states(recorded: Recorded, run: Run) -> list[_State]:
    """Return the states of the learner that tell all, in order: the last alone if nothing was corrected.

    One that cannot be read counts as not recorded.
    """
    found: list[_State] = []
    for state in reversed(run.states):
        try:
            document = documents.read('learner_state', state.text)
        except InputError as error:
            recorded.faults.append(f'{recorded.namespace}/learner_state: {error}')
            continue
        following = run.begins.get(state.turn + 1)
        decision = None if following is None else recorded.decision(following)
        is_decided = decision is not None and decision.place < state.place
        found.insert(0, _State(document, state.turn + is_decided))
        if run.episode_id not in recorded.corrected:
            break
    return found


def _course(states: Sequence[_State]) -> tuple[dict[int, QueryRecord], Mapping[int, list[QueryRecord]]]:
    """Return what came of the queries, by the turns in which they were asked, and by those in which it was told."""
    records: dict[int, QueryRecord] = {}
    told: dict[int, list[QueryRecord]] = defaultdict(list)
    for state in states:
        for record in map(documents.record_of, state.document['queries']):
            before = records.get(record.turn)
            records[record.turn] = record
            if record.outcome is Outcome.UNANSWERED or record == before:
                continue
            is_first = before is None or before.outcome is Outcome.UNANSWERED
            # A correction does not tell its own turn, but the first state with it does.
            told[(record.answered_in or record.turn) if is_first else state.decided].append(record)
    return records, told


def _multiples(step: int, last: int) -> Collection[int]:
    """Return the multiples of a step up to the last turn; none of 0."""
    return range(step, last + 1, step) if step else ()


def _content(record: QueryRecord) -> Content:
    if record.outcome is not Outcome.ANSWERED:
        return None
    if record.kind is QueryKind.LABEL:
        return record.symbol
    if record.kind is QueryKind.DEMONSTRATION:
        return NO_SYMBOL if record.object_id is None else record.object_id
    return record.groups if record.objects is None else record.objects
