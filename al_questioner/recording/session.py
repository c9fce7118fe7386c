"""The episodes that a bag holds, turn by turn, as the learner lived them."""

from __future__ import annotations

import contextlib
import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from al_questioner.domain import Decision, EpisodeSettings, InputError, QueryRecord, Scene
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
        record: what was asked and answered; None if nothing was.
    """

    turn: int
    scene: Scene
    decision: Decision
    record: QueryRecord | None


@dataclass(frozen=True, eq=False)
class Session:
    """One recorded episode, or its first turns if the recording ended before it did.

    Attributes:
        source: the bag.
        episode_id: of the episode.
        settings: of the episode.
        view_tolerance: of the learner, see `concepts.Knowledge`.
        seed: of the learner.
        world: the simulated world, as `task`, `seed`, `sample` and `dataset`; None if it was another one.
        feature_names: m names.
        turns: from the first on, without a gap.
        corrected: turns the answers to whose questions were replaced by others later.
    """

    source: Path
    episode_id: str
    settings: EpisodeSettings
    view_tolerance: float
    seed: int
    world: Document | None
    feature_names: tuple[str, ...]
    turns: tuple[RecordedTurn, ...]
    corrected: tuple[int, ...] = ()

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


@dataclass
class _Recorded:
    """What was recorded in one namespace."""

    episodes: dict[str, Document] = field(default_factory=dict)
    stamps: dict[str, dict[int, int]] = field(default_factory=lambda: defaultdict(dict))
    states: list[BagMessage] = field(default_factory=list)
    clouds: list[tuple[int, BagMessage]] = field(default_factory=list)
    decisions: dict[int, BagMessage] = field(default_factory=dict)
    asked_in: dict[tuple[str, str], int] = field(default_factory=dict)
    replacing: dict[tuple[str, str], str] = field(default_factory=dict)
    accepted: set[tuple[str, str]] = field(default_factory=set)

    def take(self, name: str, message: BagMessage) -> None:
        """Sort one message in; clouds are kept as they are until it is known which ones matter."""
        if name == 'learner_state':
            self.states.append(message)
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
        episode_id = document['episode_id']
        if name == 'query':
            self.asked_in[episode_id, document['query_id']] = document['turn']
        elif name == 'answer' and document.get('replaces') is not None:
            self.replacing[episode_id, document['answer_id']] = document['query_id']
        elif name == 'answer_ack' and document['accepted']:
            self.accepted.add((episode_id, document['answer_id']))

    def corrected(self, episode_id: str) -> tuple[int, ...]:
        """Turns of the questions the answers to which were replaced."""
        queries = {
            query_id
            for (of, answer_id), query_id in self.replacing.items()
            if of == episode_id and (of, answer_id) in self.accepted
        }
        return tuple(
            sorted({turn for (of, query_id), turn in self.asked_in.items() if of == episode_id and query_id in queries})
        )

    def last_states(self) -> dict[str, Document]:
        """The last state of the learner, by episode: it tells all that came before, so the others are not read."""
        found: dict[str, Document] = {}
        for message in reversed(self.states):
            if self.episodes.keys() <= found.keys():
                break
            document = documents.read('learner_state', deserialize(message).data)
            found.setdefault(document['episode_id'], document)
        return found


def _sessions(bag: Bag, recorded: _Recorded) -> list[Session]:
    try:
        states = recorded.last_states()
        # Latched topics tell a recorder of an episode that was over before it began: it is left out.
        begun = [episode_id for episode_id in recorded.episodes if 1 in recorded.stamps[episode_id]]
        return [
            _session(bag.path, recorded, document, states.get(episode_id))
            for episode_id, document in recorded.episodes.items()
            if not begun or episode_id in begun
        ]
    except BagError:
        raise
    except InputError as error:
        raise BagError(f'{bag.path}: {error}') from error


def _session(path: Path, recorded: _Recorded, document: Document, state: Document | None) -> Session:
    episode_id, names = document['episode_id'], tuple(document['feature_names'])
    settings = documents.settings_of(document)
    last = 0 if state is None else state['turn']
    records = {} if state is None else {q['turn']: documents.record_of(q) for q in state['queries']}
    turns = tuple(_turn(path, recorded, episode_id, turn, settings, records.get(turn)) for turn in range(1, last + 1))
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
        view_tolerance=float(document.get('view_tolerance', 1e-3)),
        seed=document['seed'],
        world=document['world'],
        feature_names=names,
        turns=turns,
        corrected=recorded.corrected(episode_id),
    )


def _turn(
    path: Path, recorded: _Recorded, episode_id: str, turn: int, settings: EpisodeSettings, record: QueryRecord | None
) -> RecordedTurn:
    stamp = recorded.stamps[episode_id].get(turn)
    if stamp is None:
        raise BagError(f'{path}: turn {turn} of {settings.turns} was not recorded: did the recording begin too late?')
    cloud = taken_cloud(recorded.clouds, stamp, recorded.stamps[episode_id].get(turn + 1, math.inf))
    decision = recorded.decisions.get(stamp)
    if cloud is None or decision is None:
        missing = 'objects' if cloud is None else 'decision'
        raise BagError(f'{path}: turn {turn} of {settings.turns} was recorded without its {missing}')
    scene = scene_of_cloud(deserialize(cloud))
    weighed = decision_of_cloud(deserialize(decision), settings.symbols, turn)
    return RecordedTurn(turn, scene, weighed, record)


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
