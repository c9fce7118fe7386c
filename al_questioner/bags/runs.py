"""Runs of learners in a bag, told apart by what the messages say and not by the recorder's clock."""

from __future__ import annotations

import contextlib
import json
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from al_questioner.bags.reading import Bag, BagMessage, deserialize
from al_questioner.bags.topics import CLOUD, TYPES, is_document, last_name
from al_questioner.domain import InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document, DocumentError
from al_questioner.messages.stamps import nanoseconds, stamp_of


class Placed(NamedTuple):
    """A message that has a stamp of its own.

    Attributes:
        place: how many messages were received before it.
        stamp: in its header, or of the turn that it begins; nanoseconds.
    """

    place: int
    stamp: int
    message: BagMessage


class State(NamedTuple):
    """A `learner_state`, not yet checked.

    Attributes:
        place: how many messages were received before it.
        turn: how many turns it says are over.
    """

    place: int
    turn: int
    text: str


@dataclass
class Run:
    """A learner from its start to its end; one that is started again under the same `episode_id` is another run.

    Attributes:
        world: the simulated world that it spoke of with its turns; None if it was another one.
        document: what it told of the episode; None if that was not recorded.
        begins: where each turn begins, and its stamp.
        states: what it told of itself, each once, by the turns that were over.
    """

    episode_id: str
    world: Document | None = None
    document: Document | None = None
    begins: dict[int, Placed] = field(default_factory=dict)
    states: list[State] = field(default_factory=list)

    @property
    def place(self) -> int:
        """Place of its first message."""
        return min((begin.place for begin in self.begins.values()), default=0)

    def takes(self, turn: int, stamp: int) -> bool:
        """Return whether a turn of this stamp can be one of these: stamps grow from turn to turn."""
        return all((turn - other) * (stamp - begin.stamp) > 0 for other, begin in self.begins.items() if other != turn)


class Recorded:
    """Content of a recording in one namespace.

    Attributes:
        namespace: the topics' names without their last parts.
        runs: of learners, in the order in which they began.
        faults: what could not be read of what should be there.
        corrected: the episodes in which an answer was replaced by another one.
    """

    def __init__(self, bag: Bag, namespace: str) -> None:
        self.namespace = namespace
        self.faults = [
            f'topic {topic.name} holds {topic.type}, expected {TYPES[last_name(topic.name)]}'
            for topic in bag.topics
            if topic.name.rpartition('/')[0] == namespace and topic.type != TYPES.get(last_name(topic.name), topic.type)
        ]
        self._clouds: list[Placed] = []
        self._decisions: dict[int, list[Placed]] = defaultdict(list)
        self._turns: list[tuple[int, Document, BagMessage]] = []
        self._episodes: list[tuple[int, Document]] = []
        self._states: list[tuple[int, BagMessage]] = []
        self._replacing: set[tuple[str, str, str]] = set()
        self._accepted: set[tuple[str, str, str]] = set()
        seen_on = _topics_of_objects(bag, namespace)
        for place, message in enumerate(bag.messages):
            if message.topic in seen_on or message.topic.rpartition('/')[0] == namespace:
                try:
                    self._take(place, message)
                except InputError as error:
                    self.faults.append(f'{message.topic}: {error}')
        self.corrected = {episode_id for episode_id, *_ in self._replacing & self._accepted}
        self.runs = self._find_runs()

    def decision(self, begin: Placed) -> Placed | None:
        """Return the decision of a turn; None if it was not recorded.

        Where a clock went back, learners may have given the same stamp: then the one next to the turn's beginning.
        """
        found = self._decisions.get(begin.stamp, [])
        return min(found, key=lambda decision: abs(decision.place - begin.place), default=None)

    def clouds(self, run: Run, turn: int) -> Iterator[Placed]:
        """Yield the messages on `objects` that a learner may have taken in a turn, in the order of its tries."""
        begin, after, decision = run.begins[turn], run.begins.get(turn + 1), self.decision(run.begins[turn])
        end = math.inf if decision is None else decision.place
        # What comes after the last turn of a learner may be the next one's.
        others = (other.stamp for run in self.runs for other in run.begins.values() if other.stamp > begin.stamp)
        until = min(others, default=math.inf) if after is None else after.stamp
        fitting = [cloud for cloud in self._clouds if begin.stamp <= cloud.stamp < until]
        # Before the turn it waits for none, but recorders do not keep to the order between topics.
        yield from sorted(fitting, key=lambda cloud: not begin.place < cloud.place < end)
        # Of a camera whose clock has gone back the learner takes what is older than its turn, too: see `TurnStamps`.
        latest, given = 0, {other.stamp for other in run.begins.values()}
        for cloud in self._clouds:
            went_back = cloud.stamp < min(latest, begin.stamp) and cloud.stamp not in given
            if went_back and decision is not None and begin.place < cloud.place < end:
                yield cloud
            latest = max(latest, cloud.stamp)

    def hint(self) -> str:
        """Return the first message that could not be read, in brackets, for people who miss something."""
        return f' ({self.faults[0]})' if self.faults else ''

    def _take(self, place: int, message: BagMessage) -> None:
        """Sort one message in.

        Raises:
            InputError: it should be ours and cannot be read.
        """
        name = last_name(message.topic)
        if name in ('objects', 'decision') and message.type == CLOUD:
            cloud = deserialize(message)
            placed = Placed(place, nanoseconds(cloud.header.stamp), message)
            if name == 'objects':
                self._clouds.append(placed)
            elif any(field.name == 'chosen' for field in cloud.fields):
                self._decisions[placed.stamp].append(placed)
        elif not is_document(message, name):
            # Anything at all may be said on such names, and the learner passes it over, too.
            return
        elif name == 'learner_state':
            self._states.append((place, message))
        elif name == 'turn':
            self._turns.append((place, documents.read(name, deserialize(message).data), message))
        elif name == 'episode':
            self._episodes.append((place, documents.read(name, deserialize(message).data)))
        elif name in ('answer', 'answer_ack'):
            with contextlib.suppress(InputError):
                document = documents.read(name, deserialize(message).data)
                ids = (document['episode_id'], document['query_id'], document['answer_id'])
                if name == 'answer' and document.get('replaces') is not None:
                    self._replacing.add(ids)
                elif name == 'answer_ack' and document['accepted']:
                    self._accepted.add(ids)

    def _find_runs(self) -> list[Run]:
        runs: list[Run] = []
        for place, document, message in self._turns:
            self._begin_turn(runs, document, Placed(place, stamp_of(document['stamp']), message))
        for place, document in self._episodes:
            _run_at(runs, document['episode_id'], place).document = document
        for place, message in self._states:
            try:
                episode_id, state = _glance(place, message)
                _run_at(runs, episode_id, place).states.append(state)
            except InputError as error:
                self.faults.append(f'{message.topic}: {error}')
        for run in runs:
            first = {state.text: state for state in reversed(run.states)}
            # Those of a turn stay in the order in which they came.
            run.states = sorted(first.values(), key=lambda state: (state.turn, state.place))
        return sorted(runs, key=lambda run: run.place)

    def _begin_turn(self, runs: list[Run], document: Document, begin: Placed) -> None:
        """Find the run that a turn belongs to; it may have been announced several times, and played in a loop."""
        episode_id, turn = document['episode_id'], document['turn']
        same = [run for run in reversed(runs) if run.episode_id == episode_id]
        if any(turn in run.begins and run.begins[turn].stamp == begin.stamp for run in same):
            return
        for run in same:
            # A learner that was killed before it decided begins the turn again.
            is_free = turn not in run.begins or self.decision(run.begins[turn]) is None
            if is_free and run.takes(turn, begin.stamp):
                run.begins[turn] = begin
                return
        runs.append(Run(episode_id, document['world'], begins={turn: begin}))


def recorded_in(bag: Bag, kinds: Sequence[str]) -> list[Recorded]:
    """Return the content of each namespace that holds documents of these kinds, in the order of their first ones."""
    ours = (message for message in bag.messages if any(is_document(message, kind) for kind in kinds))
    return [Recorded(bag, namespace) for namespace in dict.fromkeys(m.topic.rpartition('/')[0] for m in ours)]


def _topics_of_objects(bag: Bag, namespace: str) -> frozenset[str]:
    """Return the topic `objects` of a namespace, or, where perception was remapped, those of the others."""
    found = [topic.name for topic in bag.topics if last_name(topic.name) == 'objects' and topic.type == CLOUD]
    own = f'{namespace}/objects'
    return frozenset([own] if own in found else found)


def _run_at(runs: list[Run], episode_id: str, place: int) -> Run:
    """Return the run of an episode that goes on at a place."""
    same = [run for run in runs if run.episode_id == episode_id]
    if not same:
        runs.append(Run(episode_id))
        return runs[-1]
    return max((run for run in same if run.place <= place), key=lambda run: run.place, default=same[0])


def _glance(place: int, message: BagMessage) -> tuple[str, State]:
    """Read the episode of a `learner_state`, and what is needed to sort it: most of them are not needed.

    Raises:
        InputError: it tells of no turn.
    """
    text = deserialize(message).data
    try:
        document = json.loads(text)
        episode_id, turn = document['episode_id'], document['turn']
    except (ValueError, RecursionError, TypeError, KeyError) as error:
        raise DocumentError(f'learner_state: tells of no turn ({error})') from error
    if not (isinstance(episode_id, str) and isinstance(turn, int)):
        raise DocumentError('learner_state: tells of no turn')
    return episode_id, State(place, turn, text)
