"""The episodes that a bag holds, turn by turn, as the learner lived them."""

from __future__ import annotations

import contextlib
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from al_questioner.bags.reading import BagError, deserialize, read_bag
from al_questioner.bags.runs import Placed, Recorded, Run, recorded_in
from al_questioner.domain import (
    Decision,
    EpisodeSettings,
    InputError,
    Outcome,
    QueryRecord,
    Scene,
    SceneError,
    ViewTolerance,
)
from al_questioner.messages import documents
from al_questioner.messages.clouds import decision_of_cloud, scene_of_cloud
from al_questioner.messages.documents import Document


@dataclass(frozen=True, eq=False)
class RecordedTurn:
    """One turn.

    Attributes:
        turn: 1-based.
        scene: what was seen.
        decision: what was weighed and chosen; its query is None.
        record: what was asked, and answered in the end; None if nothing was.
        told: what was answered in it, also to the question of an earlier turn; a record of a query that was answered
            before corrects that answer.
    """

    turn: int
    scene: Scene
    decision: Decision
    record: QueryRecord | None
    told: tuple[QueryRecord, ...]


@dataclass(frozen=True, eq=False)
class RecordedEpisode:
    """One recorded episode, or its first turns if the recording ended before it did.

    Attributes:
        source: the bag.
        episode_id: of the episode.
        settings: of the episode.
        view_tolerance: of the learner, see `questioning.Episode`.
        seed: of the learner.
        world: the simulated world, as `task`, `seed`, `sample` and `dataset`; None if it was another one.
        feature_names: m names.
        turns: that are over, from the first on, without a gap.
        begun: the turn after them, if its scene and decision were recorded and its end was not.
    """

    source: Path
    episode_id: str
    settings: EpisodeSettings
    view_tolerance: ViewTolerance
    seed: int
    world: Document | None
    feature_names: tuple[str, ...]
    turns: tuple[RecordedTurn, ...]
    begun: RecordedTurn | None = None

    @property
    def decisions(self) -> int:
        """How many were recorded, that of a turn included whose end was not."""
        return len(self.turns) + (self.begun is not None)

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """What came of the queries, in the order of their turns."""
        return tuple(turn.record for turn in self.turns if turn.record is not None)

    @property
    def change_turns(self) -> tuple[int, ...]:
        """Turns whose scene differs from that of the turn before."""
        pairs = zip(self.turns, self.turns[1:], strict=False)
        return tuple(after.turn for before, after in pairs if _differ(before.scene, after.scene))


class LeftOut(NamedTuple):
    """Something of a bag that cannot be used.

    Attributes:
        what: id of the episode, or the namespace if that is not known.
        reason: which turns, if not all, and why.
    """

    what: str
    reason: str


def read_episodes(path: Path, left_out: list[LeftOut] | None = None) -> list[RecordedEpisode]:
    """All episodes of a bag, in the order in which they began; what other nodes say on such topics is passed over.

    An episode that was over before the recording began is none of the bag's: only latched topics tell of it.

    Args:
        path: of the bag.
        left_out: takes what cannot be used beside what can; if not given, all must be.

    Raises:
        BagError: not a bag, a broken one, or one without an episode that can be used; the text names the bag.
    """
    bag = read_bag(path)
    sessions: list[RecordedEpisode] = []
    missing: list[LeftOut] = []
    for recorded in recorded_in(bag, ('episode', 'turn')):
        for found in _sessions(path, recorded):
            if isinstance(found, RecordedEpisode):
                sessions.append(found)
            else:
                missing.append(found)
    if missing and (left_out is None or not sessions):
        raise BagError(f'{path}: {missing[0].reason}')
    if not sessions:
        raise BagError(f'{path}: no episode was recorded in it (no message on a topic named episode)')
    if left_out is not None:
        left_out += missing
    return sessions


def _sessions(path: Path, recorded: Recorded) -> Iterator[RecordedEpisode | LeftOut]:
    """The episodes of a namespace, and what of them cannot be used."""
    is_one_whole = any(run.document is not None and 1 in run.begins for run in recorded.runs)
    for run in recorded.runs:
        decided = [turn for turn, begin in sorted(run.begins.items()) if recorded.decision(begin) is not None]
        if run.document is None:
            if decided:
                topic = f'{recorded.namespace}/episode'
                yield LeftOut(run.episode_id, f'no episode was recorded for its turns ({topic}){recorded.hint()}')
            continue
        if is_one_whole and not decided and 1 not in run.begins:
            # Latched topics tell a recorder of an episode that was over before it began.
            continue
        try:
            session = _session(path, recorded, run, run.document)
        except InputError as error:
            yield LeftOut(run.episode_id, str(error))
            continue
        yield session
        beyond = [turn for turn in decided if turn > session.decisions]
        if beyond:
            turns = f'turn {beyond[0]}' if len(beyond) == 1 else f'turns {beyond[0]} to {beyond[-1]}'
            before = 'what was answered before was not recorded (no message on learner_state)'
            yield LeftOut(run.episode_id, f'{turns}: {before}{recorded.hint()}')
    if recorded.faults and not any(run.document is not None for run in recorded.runs):
        yield LeftOut(recorded.namespace or '/', recorded.faults[0])


class _State(NamedTuple):
    """What the learner told of itself.

    Attributes:
        document: which tells, as `turn`, how many turns were over.
        decided: the turn whose decision had been made.
    """

    document: Document
    decided: int


def _states(recorded: Recorded, run: Run) -> list[_State]:
    """The states of the learner that tell all, in order: the last alone if nothing was corrected.

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


def _session(path: Path, recorded: Recorded, run: Run, document: Document) -> RecordedEpisode:
    """The session of a run.

    Raises:
        InputError: it cannot be used; the text does not name the bag.
    """
    settings, names = documents.settings_of(document), tuple(document['feature_names'])
    states = _states(recorded, run)
    last = states[-1].document['turn'] if states else 0
    if run.episode_id in recorded.corrected:
        _check_without_gap(states)
    records, told = _course(states)

    def recorded_turn(turn: int) -> RecordedTurn:
        scene, decision = _seen_and_decided(recorded, run, turn, settings, names)
        return RecordedTurn(turn, scene, decision, records.get(turn), tuple(told[turn]))

    turns = tuple(map(recorded_turn, range(1, last + 1)))
    if not turns:
        raise InputError(f'the recording ended before the first turn of episode {run.episode_id} did{recorded.hint()}')
    begun = None
    with contextlib.suppress(InputError):
        begun = recorded_turn(last + 1)
    return RecordedEpisode(
        source=path,
        episode_id=run.episode_id,
        settings=settings,
        view_tolerance=document.get('view_tolerance', 1e-3),
        seed=document['seed'],
        world=document['world'],
        feature_names=names,
        turns=turns,
        begun=begun,
    )


def _check_without_gap(states: Sequence[_State]) -> None:
    """Make sure that it can be said in which turn an answer was corrected."""
    turns = {state.document['turn'] for state in states}
    for turn in range(1, max(turns, default=0)):
        if turn not in turns:
            raise InputError(
                f'turn {turn} was recorded without its learner_state: what was known then cannot be said,'
                ' as an answer was corrected'
            )


def _course(states: Sequence[_State]) -> tuple[dict[int, QueryRecord], Mapping[int, list[QueryRecord]]]:
    """What came of the queries in the end, by the turns in which they were asked, and by those in which it was told."""
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


def _seen_and_decided(
    recorded: Recorded, run: Run, turn: int, settings: EpisodeSettings, names: tuple[str, ...]
) -> tuple[Scene, Decision]:
    begin = run.begins.get(turn)
    if begin is None:
        late = 'did the recording begin too late?'
        raise InputError(f'turn {turn} of {settings.turns} was not recorded: {late}{recorded.hint()}')
    scene = _seen(recorded.clouds(run, turn), turn, names)
    decision = recorded.decision(begin)
    if scene is None or decision is None:
        missing = 'objects' if scene is None else 'decision'
        # A learner that is killed and resumed may leave such a gap: its session has what no message told.
        raise InputError(
            f'turn {turn} of {settings.turns} was recorded without its {missing}{recorded.hint()};'
            ' if the learner kept a session, `session DIR --bag NEW_BAG` writes a whole bag'
        )
    return scene, decision_of_cloud(deserialize(decision.message), settings.symbols, turn)


def _seen(clouds: Iterator[Placed], turn: int, names: tuple[str, ...]) -> Scene | None:
    """The scene of the first cloud that a learner takes, None if there is no cloud: another node's it passes over.

    Raises:
        InputError: there are clouds, and it takes none of them.
    """
    reasons: list[str] = []
    for cloud in clouds:
        try:
            scene = scene_of_cloud(deserialize(cloud.message), names)
        except (SceneError, BagError) as error:
            reasons.append(f'turn {turn}: {error}')
            continue
        if scene.feature_names == names:
            return scene
        other = f'other features than the episode announces ({len(scene.feature_names)}, announced {len(names)})'
        reasons.append(f'the objects of turn {turn} have {other}')
    if reasons:
        raise InputError(reasons[0])
    return None


def _differ(before: Scene, after: Scene) -> bool:
    return before.object_ids != after.object_ids or before.features.tobytes() != after.features.tobytes()
