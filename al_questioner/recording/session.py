"""The episodes that a bag holds, turn by turn, as the learner lived them."""

from __future__ import annotations

import contextlib
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from al_questioner.domain import Decision, EpisodeSettings, InputError, Outcome, QueryRecord, Scene, ViewTolerance
from al_questioner.messages import documents
from al_questioner.messages.clouds import decision_of_cloud, scene_of_cloud
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import nanoseconds, stamp_of
from al_questioner.recording.bags import Bag, BagError, BagMessage, deserialize, read_bag

STRING = 'std_msgs/msg/String'
CLOUD = 'sensor_msgs/msg/PointCloud2'
TYPES: Mapping[str, str] = {
    'episode': STRING,
    'turn': STRING,
    'objects': CLOUD,
    'query': STRING,
    'answer': STRING,
    'answer_ack': STRING,
    'decision': CLOUD,
    'learner_state': STRING,
}
"""What a recording holds: message type by the last part of the topic's name."""


@dataclass(frozen=True, eq=False)
class RecordedTurn:
    """One turn.

    Attributes:
        turn: 1-based.
        scene: what was seen.
        decision: what was weighed and chosen; its query is None.
        record: what was asked, and answered in the end; None if nothing was.
        told: what was answered in it, be it to the question of an earlier turn; a record of a query that was answered
            before corrects that answer.
    """

    turn: int
    scene: Scene
    decision: Decision
    record: QueryRecord | None
    told: tuple[QueryRecord, ...]


@dataclass(frozen=True, eq=False)
class Session:
    """One recorded episode, or its first turns if the recording ended before it did.

    Attributes:
        source: the bag.
        episode_id: of the episode.
        settings: of the episode.
        view_tolerance: of the learner, see `questioning.Episode`.
        seed: of the learner.
        world: the simulated world, as `task`, `seed`, `sample` and `dataset`; None if it was another one.
        feature_names: m names.
        turns: from the first on, without a gap.
    """

    source: Path
    episode_id: str
    settings: EpisodeSettings
    view_tolerance: ViewTolerance
    seed: int
    world: Document | None
    feature_names: tuple[str, ...]
    turns: tuple[RecordedTurn, ...]

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """What came of the queries, in the order of their turns."""
        return tuple(turn.record for turn in self.turns if turn.record is not None)

    @property
    def change_turns(self) -> tuple[int, ...]:
        """Turns whose scene differs from that of the turn before."""
        pairs = zip(self.turns, self.turns[1:], strict=False)
        return tuple(after.turn for before, after in pairs if _differ(before.scene, after.scene))


def read_sessions(path: Path, too_short: list[str] | None = None) -> list[Session]:
    """All episodes of a bag, in the order in which they began.

    Args:
        path: of the bag.
        too_short: takes the ids of episodes of which not even one turn was recorded whole, beside others of which one
            was; if not given, there must be none.

    Raises:
        BagError: not a bag, a broken one, or one whose messages are not those of an episode; the text names the bag.
    """
    bag = read_bag(path)
    by_namespace: dict[str, _Recorded] = defaultdict(_Recorded)
    for topic in bag.topics:
        name = topic.name.rsplit('/', 1)[-1]
        if name in TYPES and topic.type != TYPES[name]:
            raise BagError(f'{path}: topic {topic.name} holds {topic.type}, expected {TYPES[name]}')
    for message in bag.messages:
        namespace, _, name = message.topic.rpartition('/')
        if name in TYPES:
            try:
                by_namespace[namespace].take(name, message)
            except BagError:
                raise
            except InputError as error:
                raise BagError(f'{path}: {message.topic}: {error}') from error
    sessions = [session for recorded in by_namespace.values() for session in _sessions(bag, recorded)]
    whole = [session for session in sessions if session.turns]
    for session in sessions:
        if not session.turns and whole and too_short is not None:
            too_short.append(session.episode_id)
        elif not session.turns:
            what = f'the first turn of episode {session.episode_id} did'
            raise BagError(f'{path}: the recording ended before {what}')
    if not sessions:
        raise BagError(f'{path}: no episode was recorded in it (no message on a topic named episode)')
    return whole


@dataclass(frozen=True)
class _State:
    """What the learner told of itself.

    Attributes:
        document: which tells, as `turn`, how many turns were over.
        decided: turns whose decision had been made.
    """

    document: Document
    decided: int


@dataclass
class _Recorded:
    """What was recorded in one namespace."""

    episodes: dict[str, Document] = field(default_factory=dict)
    stamps: dict[str, dict[int, int]] = field(default_factory=lambda: defaultdict(dict))
    states: list[tuple[int, BagMessage]] = field(default_factory=list)
    clouds: list[tuple[int, BagMessage]] = field(default_factory=list)
    decisions: dict[int, BagMessage] = field(default_factory=dict)
    replacing: set[tuple[str, str, str]] = field(default_factory=set)
    accepted: set[tuple[str, str, str]] = field(default_factory=set)

    def take(self, name: str, message: BagMessage) -> None:
        """Sort one message in; clouds are kept as they are until it is known which ones matter.

        A state is kept with the stamp of the last decision before it.
        """
        if name == 'learner_state':
            self.states.append((next(reversed(self.decisions), 0), message))
            return
        content = deserialize(message)
        if name == 'objects':
            self.clouds.append((nanoseconds(content.header.stamp), message))
        elif name == 'decision':
            self.decisions[nanoseconds(content.header.stamp)] = message
        elif name in ('episode', 'turn'):
            document = documents.read(name, content.data)
            episode_id = document['episode_id']
            if name == 'turn':
                self.stamps[episode_id][document['turn']] = stamp_of(document['stamp'])
            else:
                self.episodes[episode_id] = document
        else:
            # Anything at all may have been said; what is no document corrects nothing.
            with contextlib.suppress(InputError):
                self._take_talk(name, documents.read(name, content.data))

    def _take_talk(self, name: str, document: Document) -> None:
        if name == 'answer' and document.get('replaces') is not None:
            self.replacing.add((document['episode_id'], document['query_id'], document['answer_id']))
        elif name == 'answer_ack' and document['accepted']:
            self.accepted.add((document['episode_id'], document['query_id'], document['answer_id']))

    @property
    def corrected(self) -> set[str]:
        """The episodes in which an answer was replaced by another one."""
        return {episode_id for episode_id, *_ in self.replacing & self.accepted}

    def states_by_episode(self) -> dict[str, list[_State]]:
        """The states of the learner that tell all, in order, by episode: the last alone if nothing was corrected."""
        found: dict[str, list[_State]] = {}
        corrected = self.corrected
        for decision, message in reversed(self.states):
            if not corrected and self.episodes.keys() <= found.keys():
                break
            document = documents.read('learner_state', deserialize(message).data)
            episode_id = document['episode_id']
            states = found.setdefault(episode_id, [])
            if not states or episode_id in corrected:
                decided = [turn for turn, stamp in self.stamps[episode_id].items() if stamp == decision]
                states.insert(0, _State(document, max([document['turn'], *decided])))
        return found


def _sessions(bag: Bag, recorded: _Recorded) -> list[Session]:
    try:
        states = recorded.states_by_episode()
        # Latched topics tell a recorder of an episode that was over before it began: it is left out.
        begun = [episode_id for episode_id in recorded.episodes if 1 in recorded.stamps[episode_id]]
        return [
            _session(bag.path, recorded, document, states.get(episode_id, []))
            for episode_id, document in recorded.episodes.items()
            if not begun or episode_id in begun
        ]
    except BagError:
        raise
    except InputError as error:
        raise BagError(f'{bag.path}: {error}') from error


def _session(path: Path, recorded: _Recorded, document: Document, states: Sequence[_State]) -> Session:
    episode_id, names = document['episode_id'], tuple(document['feature_names'])
    settings = documents.settings_of(document)
    last = states[-1].document['turn'] if states else 0
    if episode_id in recorded.corrected:
        _check_without_gap(path, states)
    records, told = _course(states)
    turns = tuple(
        RecordedTurn(
            turn, *_seen_and_decided(path, recorded, episode_id, turn, settings), records.get(turn), tuple(told[turn])
        )
        for turn in range(1, last + 1)
    )
    for turn in turns:
        if turn.scene.feature_names != names:
            raise BagError(
                f'{path}: the objects of turn {turn.turn} have other features than the episode announces'
                f' ({len(turn.scene.feature_names)}, announced {len(names)})'
            )
    return Session(
        source=path,
        episode_id=episode_id,
        settings=settings,
        view_tolerance=document.get('view_tolerance', 1e-3),
        seed=document['seed'],
        world=document['world'],
        feature_names=names,
        turns=turns,
    )


def _check_without_gap(path: Path, states: Sequence[_State]) -> None:
    """Make sure that it can be said in which turn an answer was corrected."""
    turns = {state.document['turn'] for state in states}
    for turn in range(1, max(turns, default=0)):
        if turn not in turns:
            raise BagError(
                f'{path}: turn {turn} was recorded without its learner_state: what was known then cannot be said,'
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
    path: Path, recorded: _Recorded, episode_id: str, turn: int, settings: EpisodeSettings
) -> tuple[Scene, Decision]:
    stamp = recorded.stamps[episode_id].get(turn)
    if stamp is None:
        raise BagError(f'{path}: turn {turn} of {settings.turns} was not recorded: did the recording begin too late?')
    cloud = taken_cloud(recorded.clouds, stamp, recorded.stamps[episode_id].get(turn + 1, math.inf))
    decision = recorded.decisions.get(stamp)
    if cloud is None or decision is None:
        missing = 'objects' if cloud is None else 'decision'
        # A learner that is killed and resumed may leave such a gap: its session has what no message told.
        raise BagError(
            f'{path}: turn {turn} of {settings.turns} was recorded without its {missing};'
            ' if the learner kept a session, `session DIR --bag NEW_BAG` writes a whole bag'
        )
    return scene_of_cloud(deserialize(cloud)), decision_of_cloud(deserialize(decision), settings.symbols, turn)


def taken_cloud(clouds: Sequence[tuple[int, BagMessage]], begin: int, end: float) -> BagMessage | None:
    """The `objects` of a turn: the learner takes the first cloud that is not older than it.

    Args:
        clouds: with their stamps, in the order in which they were received.
        begin: stamp of the turn.
        end: stamp of the next one; a cloud of that came too late.
    """
    return next((message for at, message in clouds if begin <= at < end), None)


def _differ(before: Scene, after: Scene) -> bool:
    return before.object_ids != after.object_ids or before.features.tobytes() != after.features.tobytes()
