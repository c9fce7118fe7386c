"""The promises of the learner, held after each step against a book-keeping that reads nothing but the disk."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from al_questioner.domain import Answer
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import LogContents
from al_questioner.event_log.replay import Replay, ReplayError
from al_questioner.event_log.state_documents import state_members
from al_questioner.event_log.storage import Event as LoggedEvent
from al_questioner.messages import documents
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.effects import Effect, Publish, Refuse
from al_questioner.protocol.events import Event, Heard
from al_questioner.questioning import make_strategy
from shared.bottle.disk import Disk
from shared.bottle.faults import Faults
from shared.bottle.table import Table

SHARES = {'answered': 1.0, 'unknown': 1.0, 'skip': 1.0, 'unanswered': 0.0}
"""Share of its price that a query is charged, by what came of it."""


class BrokenPromiseError(BaseException):
    """A promise that was broken; no machine may take it for an error of its own."""


class Promises:
    """Watches one learner.

    Args:
        name: of the learner's robot.
        table: what is really there.
        scene_number: number of the scene that is there in a turn, where that is known.
        faults: for what is looked at now and then only.
        replay_rate: share of the states that are compared with a replay of the log.

    Attributes:
        is_suspicious: whether every state is.
    """

    def __init__(
        self, name: str, table: Table, scene_number: Callable[[int], int] | None, faults: Faults, replay_rate: float
    ) -> None:
        self.name = name
        self.started: EpisodeStarted | None = None
        self._table, self._scene_number, self._faults, self._replay_rate = table, scene_number, faults, replay_rate
        self._said: set[tuple[Any, ...]] = set()
        self._states = 0
        self.is_suspicious = False
        self.forget()

    @property
    def episode_id(self) -> str:
        """Id of the present episode; empty before the first."""
        return '' if self.started is None else self.started.episode_id

    def forget(self) -> None:
        """Begin with another episode, on an empty disk."""
        self.disk = Disk(self.note_commit)
        self.is_done = False
        self._stamps: dict[int, int] = {}
        self._answers: dict[str, dict[str, Any]] = {}
        self._ids: set[tuple[str, str]] = set()
        self._settled_before: set[str] = set()
        self._late: set[tuple[str, str]] = set()
        self._queries: dict[str, dict[str, Any]] = {}
        self._looks: dict[str, dict[int, int]] = {}
        self._scene: SceneObserved | None = None
        self._texts: dict[str, str] = {}
        self._furthest = (-1, False)
        self._last_state, self._events_told = '', 0

    def note_commit(self, events: list[LoggedEvent]) -> None:
        """Look at what has just been synced."""
        for event in events:
            members = json.loads(event.content)
            if event.kind == 'scene':
                found, _ = decoded(LogContents(tuple(self._with_scene()), None))
                self._scene = next(one for one in reversed(found) if isinstance(one, SceneObserved))
                self._check_scene(self._scene)
            elif event.kind == 'decision' and members['query'] is not None:
                self._note_query(members['query'])
            elif event.kind in ('answer', 'correction'):
                self._note_answer(members)
            elif event.kind == 'passed' and self.started is not None:
                if members['turn'] == self.started.settings.turns:
                    # It is withdrawn then, and an answer that comes later costs no more than what is left.
                    self._settled_before.add(members['query_id'])
            elif event.kind == 'late':
                self._late.add((members['query_id'], members['answer_id']))

    def _with_scene(self) -> list[LoggedEvent]:
        """Return the first event and the last scene that was written out, with those that refer to it."""
        scenes = [event for event in self.disk.events if event.kind == 'scene']
        whole = next(i for i in range(len(scenes) - 1, -1, -1) if b'"scene":null' not in scenes[i].content)
        return [self.disk.events[0], *scenes[whole:]]

    def _check_scene(self, observed: SceneObserved) -> None:
        if self._scene_number is not None:
            there = self._table.scene(self._scene_number(observed.turn))
            is_there = observed.scene.equals(there)
            self.demand(is_there, f'the scene of turn {observed.turn} is not what was there in that turn')

    def _note_query(self, query: dict[str, Any]) -> None:
        query_id = query['query_id']
        self.demand(query_id not in self._queries, f'the query {query_id} was decided twice')
        self._queries[query_id] = query
        scene = self._scene
        assert scene is not None
        ids, rows = scene.scene.object_ids, scene.scene.features
        looks = {i: self._table.look(i, row) for i, row in zip(ids, rows, strict=True)}
        self._looks[query_id] = looks
        if query['kind'] == 'label' and self._table.repeats_exactly:
            asked = query['object_id']
            for other, answer in self._answers.items():
                named = self._named(other, answer)
                self.demand(
                    named is None or (named, self._looks[other].get(named)) != (asked, looks[asked]),
                    f'{query_id} asks what object {asked} is: the answer to {other} has told, and it looks the same',
                )

    def _named(self, query_id: str, answer: dict[str, Any]) -> int | None:
        """Return the thing that an answer names."""
        query = self._queries[query_id]
        if answer['outcome'] != 'answered':
            return None
        if query['kind'] == 'label':
            return int(query['object_id'])
        return answer['content'] if query['kind'] == 'demonstration' and answer['content'] != 'none' else None

    def _note_answer(self, answer: dict[str, Any]) -> None:
        query_id, answer_id, replaces = answer['query_id'], answer['answer_id'], answer.get('replaces')
        self.demand(query_id in self._queries, f'an answer to {query_id} counts, which was never asked')
        self.demand((query_id, answer_id) not in self._ids, f'the answer {answer_id} counts twice')
        before = self._answers.get(query_id)
        self.demand(
            (before is None) == (replaces is None) and (before is None or before['answer_id'] == replaces),
            f'{answer_id} counts for {query_id} beside {before and before["answer_id"]}',
        )
        assert self.started is not None
        content = json.dumps(answer.get('content'))
        said = (self.started.episode_id, query_id, answer_id, answer['outcome'], content, replaces)
        plain = (None, None, None, answer['outcome'], content, None)
        is_plain = answer_id == f'{query_id}/plain' and plain in self._said
        self.demand(said in self._said or is_plain, f'nobody said {answer_id}: {said}')
        self._ids.add((query_id, answer_id))
        if replaces is not None or query_id != next(reversed(self._queries)):
            # What was settled already costs no more than what is left of the budget.
            self._settled_before.add(query_id)
        self._answers[query_id] = answer

    def note_said(self, text: str, outcome: str = '', content: Any = None) -> None:
        """Take note of what somebody said: a document, or a plain word with what it means."""
        if text.startswith('{'):
            answer = json.loads(text)
            ids = answer['episode_id'], answer['query_id'], answer['answer_id']
            self._said.add((*ids, answer['outcome'], json.dumps(answer.get('content')), answer.get('replaces')))
        else:
            self._said.add((None, None, None, outcome, json.dumps(content), None))

    def note_answer_said(self, episode_id: str, answer: Answer) -> None:
        """Take note of what somebody said at a terminal."""
        self.note_said(documents.write('answer', episode_id, documents.answer_members(answer)))

    def watch(self, effect: Effect, has_failed: bool) -> None:
        """Look at what the learner is about to do."""
        if not isinstance(effect, Publish):
            return
        speaks = effect.topic in ('turn', 'query', 'decision')
        self.demand(not (has_failed and speaks), f'it could not write, and publishes {effect.topic} all the same')
        if effect.topic == 'answer_ack':
            ack = json.loads(effect.content)
            key = (ack.get('query_id'), ack.get('answer_id'))
            self.demand(not ack['accepted'] or key in self._ids, f'{key} is acknowledged and not on the disk')
            is_late = 'was answered already' in ack['reason']
            self.demand(not is_late or key in self._late, f'{key} is said to be late and not on the disk')
        elif effect.topic == 'query':
            query = json.loads(effect.content)
            query_id = query['query_id']
            self.demand(query_id in self._queries, f'{query_id} is asked and not on the disk')
            self.demand(query_id not in self._answers, f'{query_id} is asked again, and was answered')
            self.demand(self._texts.setdefault(query_id, effect.content) == effect.content, f'{query_id} has changed')
        elif effect.topic == 'learner_state':
            self._watch_state(effect.content)
        elif effect.topic in ('turn', 'episode') and self.started is not None:
            theirs = json.loads(effect.content)['episode_id']
            self.demand(theirs == self.started.episode_id, f'it speaks of the episode {theirs}')
        if effect.topic == 'turn':
            self._watch_turn(json.loads(effect.content))

    def _watch_turn(self, turn: dict[str, Any]) -> None:
        """Look at the stamp of a turn: a scene may be recognised by it as that of the turn."""
        number, stamp = turn['turn'], stamp_of(turn['stamp'])
        later = [other for other, its in self._stamps.items() if other < number and its >= stamp]
        self.demand(not later, f'turn {number} has an earlier stamp than turn {later and later[0]}')
        self._stamps[number] = stamp

    def _watch_state(self, text: str) -> None:
        state = json.loads(text)
        now = (state['turn'], state['done'])
        self.demand(now >= self._furthest, f'the state goes back from {self._furthest} to {now}')
        self._furthest = now
        self.is_done = self.is_done or state['done']
        costs = sum(record['cost'] for record in state['queries'])
        self.demand(state['spent'] == costs, f'{state["spent"]} is spent, the queries cost {costs}')
        self.demand(state['spent'] <= state['budget'], f'{state["spent"]} is spent of {state["budget"]}')
        for record in state['queries']:
            query = next(each for each in self._queries.values() if each['turn'] == record['turn'])
            price = query['cost'] * SHARES[record['outcome']]
            self.demand(record['cost'] <= price, f'{query["query_id"]} costs {price}, not {record["cost"]}')
            is_whole = (
                record['cost'] == price or record['outcome'] != 'answered' or query['query_id'] in self._settled_before
            )
            self.demand(is_whole, f'{query["query_id"]} costs {price}, only {record["cost"]} is charged')
        turns = [query['turn'] for query in self._queries.values()]
        told = {record['turn']: record for record in state['queries']}
        self.demand(set(told) <= set(turns), f'there are records of turns without a question: {sorted(told)}')
        for query_id, answer in self._answers.items():
            record = told.get(self._queries[query_id]['turn'])
            self.demand(
                record is not None and record['outcome'] == answer['outcome'],
                f'the record of {query_id} is {record}, the answer that counts is {answer}',
            )
        answered = {self._queries[query_id]['turn'] for query_id in self._answers}
        guessed = [r for r in told.values() if r['outcome'] == 'answered' and r['turn'] not in answered]
        self.demand(not guessed, f'records without an answer: {guessed}')
        if text != self._last_state:
            self._last_state, self._events_told = text, self._events_that_count
            self._states += 1
            if self.is_suspicious or self._faults.draw('replay', self.name, self._states) < self._replay_rate:
                self.compare_with_log(state)

    def compare_with_log(self, state: dict[str, Any]) -> None:
        """Hold a state against a replay of all that is on the disk."""
        found, fault = decoded(LogContents(tuple(self.disk.events), None))
        self.demand(fault is None, f'the log cannot be read: {fault}')
        first = found[0]
        assert isinstance(first, EpisodeStarted)
        replay = Replay(first, make_strategy(first.settings.strategy, first.settings.weights), is_strict=True)
        try:
            for event in found[1:]:
                replay.play(event)
        except ReplayError as error:
            raise BrokenPromiseError(f'{self.name}: the log cannot be played again: {error}') from error
        beliefs = replay.episode.concepts.predict_proba(replay.episode.scene.features)
        expected = json.loads(
            documents.write('learner_state', first.episode_id, state_members(replay.episode, beliefs))
        )
        differing = [name for name in expected if expected[name] != state.get(name)]
        self.demand(not differing, f'a replay of the log believes otherwise: {differing}')

    def watch_rival(self, event: Event, warning: str, is_over: bool) -> None:
        """Look at whether another learner on the same topics is noticed."""
        if isinstance(event, Heard) and event.topic == 'turn' and self.started is not None and not is_over:
            theirs = json.loads(event.content)['episode_id']
            if theirs != self.started.episode_id:
                self.demand('another learner' in warning, f'nothing warns of the learner of {theirs}')

    def watch_handled(self, event: Event, effects: list[Effect], is_ready: bool, garbage: set[str]) -> None:
        """Look at what became of a message."""
        if not (isinstance(event, Heard) and event.topic == 'answer' and is_ready):
            return
        acks = [each for each in effects if isinstance(each, Publish) and each.topic == 'answer_ack']
        self.demand(len(acks) == 1, f'{len(acks)} acknowledgements of {event.content[:80]!r}')
        if event.content in garbage:
            is_refused = any(isinstance(each, Refuse) for each in effects)
            self.demand(is_refused, f'{event.content[:80]!r} was not refused')
            self.demand(not json.loads(acks[0].content)['accepted'], f'{event.content[:80]!r} was accepted')

    def check_end(self) -> None:
        """Hold the last state against the log."""
        self.demand(self.is_done, 'the episode does not end although all faults have stopped')
        is_told = self._events_told == self._events_that_count
        self.demand(is_told, 'the last state does not tell of all that is on the disk')
        self.compare_with_log(json.loads(self._last_state))

    @property
    def _events_that_count(self) -> int:
        """Number of events on the disk that change what is known."""
        return sum(event.kind != 'refused' for event in self.disk.events)

    def demand(self, is_kept: bool, what: str) -> None:
        if not is_kept:
            raise BrokenPromiseError(f'{self.name}: {what}')
