"""Faults put into the code on purpose, to see how soon the bottle finds each.

    PYTHONPATH=test python -m shared.bottle.mutations [--most SEEDS] [--chart FAULT]

prints a table of the seeds that it took, or the course of events that one fault leads to.
"""

from __future__ import annotations

import argparse
import contextlib
import dataclasses
import json
import sys
from collections.abc import Callable, Iterator
from typing import Any
from unittest import mock

import numpy as np

from al_questioner.domain import Answer, Costs, Outcome, QueryKind, Scene
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import AnswerAccepted, LateAnswerKept, SceneObserved
from al_questioner.event_log.replay import Replay
from al_questioner.messages import documents
from al_questioner.protocol import answer_sender, learner, machine, retransmitter, scripted_teacher, turn_stamps
from al_questioner.protocol.effects import Publish, Refuse
from al_questioner.protocol.events import Moment, TimerFired
from al_questioner.questioning import Receipt, answers, episode
from al_questioner.questioning.turn_context import TurnContext
from shared.bottle import disk, process
from shared.bottle.bottle import run
from shared.bottle.failing import explain

MOST_SEEDS = 1000
Mutation = Callable[[], 'contextlib.AbstractContextManager[Any]']
MUTATIONS: dict[str, Mutation] = {}
"""Mutations by what they do wrong."""


def mutation(what: str) -> Callable[[Mutation], Mutation]:
    def add(make: Mutation) -> Mutation:
        MUTATIONS[what] = make
        return make

    return add


@mutation('acknowledges an answer before it is written')
def _acknowledge_first() -> Any:
    def take(self: DurableEpisode, answer: Answer) -> Any:
        prepared = self.episode.prepare(answer)
        if prepared.is_kept:
            self.episode.commit(prepared)
            late = LateAnswerKept(answer, prepared.reason)
            self._owed = [
                *getattr(self, '_owed', []),
                late if prepared.receipt is Receipt.LATE else AnswerAccepted(answer),
            ]
        return prepared

    write = DurableEpisode._write

    def write_what_is_owed(self: DurableEpisode, *events: Any) -> None:
        owed, self._owed = getattr(self, '_owed', []), []
        write(self, *owed, *events)

    return mock.patch.multiple(DurableEpisode, take=take, _write=write_what_is_owed)


@mutation('asks before the decision is written')
def _ask_first() -> Any:
    ask = DurableEpisode.ask

    def ask_first(self: DurableEpisode, observed: SceneObserved) -> Any:
        write, held = self._write, []
        self._write = lambda *events: held.extend(events)
        decision = ask(self, observed)

        def write_later(*events: Any) -> None:
            del self._write
            write(*held, *events)

        self._write = write_later
        return decision

    return mock.patch.object(DurableEpisode, 'ask', ask_first)


@mutation('forgets the check for duplicates')
def _no_duplicates() -> Any:
    receipt_for = answers.AnswerHistory.receipt_for

    def forgetful(self: Any, answer: Answer) -> Receipt:
        receipt = receipt_for(self, answer)
        return Receipt.ACCEPTED if receipt is Receipt.DUPLICATE else receipt

    return mock.patch.object(answers.AnswerHistory, 'receipt_for', forgetful)


@mutation('lets a second answer to a query count')
def _late_counts() -> Any:
    receipt_for = answers.AnswerHistory.receipt_for

    def lenient(self: Any, answer: Answer) -> Receipt:
        receipt = receipt_for(self, answer)
        return Receipt.ACCEPTED if receipt is Receipt.LATE else receipt

    return mock.patch.object(answers.AnswerHistory, 'receipt_for', lenient)


@mutation('repeats an answer under a new id')
def _new_ids() -> Any:
    transmit = retransmitter.Retransmitter._transmit

    def transmit_renamed(self: Any) -> Any:
        if self.message is not None and self.message.topic == 'answer':
            members = json.loads(self.message.content)
            self.message = Publish('answer', json.dumps({**members, 'answer_id': members['answer_id'] + "'"}))
        yield from transmit(self)

    return mock.patch.object(retransmitter.Retransmitter, '_transmit', transmit_renamed)


@mutation('does not stop the repetition of a question')
def _no_stop() -> Any:
    def stop(self: Any) -> Any:
        yield from ()

    return mock.patch.object(retransmitter.Retransmitter, 'stop', stop)


@mutation('says everything once only')
def _no_repetition() -> Any:
    def transmit(self: Any) -> Any:
        if self.message is not None:
            yield self.message

    return mock.patch.object(retransmitter.Retransmitter, '_transmit', transmit)


@mutation('waits by the clock that may jump')
def _wall_clock() -> Any:
    handle = learner.LearnerMachine.handle

    def handle_by_clock(self: Any, event: Any, now: Moment) -> Any:
        yield from handle(self, event, Moment(now.clock / 1e9, now.clock))

    return mock.patch.object(learner.LearnerMachine, 'handle', handle_by_clock)


@mutation('forgets the stamps when it goes on')
def _no_stamps() -> Any:
    def forget(earlier: Any = ()) -> Any:
        return turn_stamps.TurnStamps()

    return mock.patch.object(learner, 'TurnStamps', forget)


@mutation('takes any scene for that of the turn')
def _any_scene() -> Any:
    return mock.patch.object(turn_stamps.TurnStamps, 'is_of_turn', return_value=True)


@mutation('goes on without the corrections')
def _no_corrections() -> Any:
    play = Replay.play

    def play_others(self: Replay, event: Any) -> None:
        if not (isinstance(event, AnswerAccepted) and event.answer.replaces is not None):
            play(self, event)

    def start(self: DurableEpisode) -> None:
        with mock.patch.object(Replay, 'play', play_others):
            original(self)

    original = DurableEpisode.start
    return mock.patch.object(DurableEpisode, 'start', start)


@mutation('goes on with another random stream')
def _other_stream() -> Any:
    original = DurableEpisode.start

    def start(self: DurableEpisode) -> None:
        if self._events:
            self.started = dataclasses.replace(self.started, seed=self.started.seed + 1)
        original(self)

    return mock.patch.object(DurableEpisode, 'start', start)


@mutation('takes a late answer for one to the present query')
def _late_to_present() -> Any:
    read = learner.LearnerMachine._read_answer

    def read_for_present(self: Any, content: str) -> Answer:
        answer, pending = read(self, content), self._durable.episode.pending
        if pending is None or answer.replaces is not None:
            return answer
        return dataclasses.replace(answer, query_id=pending.query_id)

    return mock.patch.object(learner.LearnerMachine, '_read_answer', read_for_present)


@mutation('does not write that a turn timed out')
def _no_time_out() -> Any:
    def time_out(self: DurableEpisode) -> None:
        self.episode.time_out()

    return mock.patch.object(DurableEpisode, 'time_out', time_out)


@mutation('guesses the answer when nobody gives one')
def _guess() -> Any:
    time_out = DurableEpisode.time_out

    def guess(self: DurableEpisode) -> None:
        query = self.episode.awaited
        if query is not None and query.action.kind is QueryKind.LABEL:
            self.take(Answer(query.query_id, f'{query.query_id}/guess', 'guess', Outcome.ANSWERED, query.choices[0]))
        else:
            time_out(self)

    return mock.patch.object(DurableEpisode, 'time_out', guess)


@mutation('does not acknowledge what it has heard before')
def _no_second_ack() -> Any:
    hear = learner.LearnerMachine._hear

    def hear_once(self: Any, text: str) -> Any:
        if text in self.__dict__.setdefault('_texts', set()):
            return
        self._texts.add(text)
        yield from hear(self, text)

    return mock.patch.object(learner.LearnerMachine, '_hear', hear_once)


@mutation('refuses in silence')
def _silent_refusal() -> Any:
    handle = machine.Machine.handle

    def handle_silently(self: Any, event: Any, now: Any) -> Any:
        for effect in handle(self, event, now):
            if not isinstance(effect, Refuse):
                yield effect

    return mock.patch.object(machine.Machine, 'handle', handle_silently)


@mutation('tells of a scene that could not be written')
def _tell_unwritten() -> Any:
    tell = learner.LearnerMachine._tell_state

    def tell_always(self: Any) -> Any:
        failed, self._has_failed = self._has_failed, False
        try:
            yield from tell(self)
        finally:
            self._has_failed = failed

    return mock.patch.object(learner.LearnerMachine, '_tell_state', tell_always)


@mutation('asks again about what it knows')
def _ask_again() -> Any:
    nothing = property(lambda self: np.zeros(len(self.scene), dtype=bool))
    return mock.patch.object(TurnContext, 'labelled', nothing)


@mutation('takes a scene with the same things for the same scene')
def _same_things() -> Any:
    def equals(self: Scene, other: Scene) -> bool:
        return self.object_ids == other.object_ids

    return mock.patch.object(Scene, 'equals', equals)


@mutation('charges twice for an answer in a later turn')
def _charge_twice() -> Any:
    charged = episode.Episode._charged

    def charge(self: Any, query: Any, outcome: Outcome) -> float:
        return charged(self, query, outcome) * (2 if query.turn != self.turn else 1)

    return mock.patch.object(episode.Episode, '_charged', charge)


@mutation('charges nothing for an answer')
def _charge_nothing() -> Any:
    return mock.patch.object(Costs, 'charged_fraction', return_value=0.0)


@mutation('does not notice another learner')
def _no_rival() -> Any:
    def hear_turn(self: Any, document: Any) -> Any:
        yield from ()

    return mock.patch.object(learner.LearnerMachine, '_hear_turn', hear_turn)


@mutation('does not sync what it writes')
def _no_sync() -> Any:
    def append(self: Any, *entries: Any) -> None:
        pending = self.__dict__.setdefault('_pending', [])
        pending.append(entries)
        if len(pending) > 1:
            write(self, *pending.pop(0))

    write = disk.SimulatedLog.append
    return mock.patch.object(disk.SimulatedLog, 'append', append)


@mutation('sends an acknowledged answer on')
def _never_acknowledged() -> Any:
    def acknowledged(self: Any, document: Any) -> Any:
        yield from ()

    return mock.patch.object(answer_sender.AnswerSender, '_acknowledged', acknowledged)


@mutation('answers the next episode with the answer of the last one')
def _old_episode() -> Any:
    def consider(self: Any, document: Any) -> Any:
        query = documents.query_of(document)
        self.episode_id = document['episode_id']
        yield from self.sender.send(self._teacher.answer(query, self._truth(query.turn)), self._delay)

    return mock.patch.object(scripted_teacher.ScriptedTeacherMachine, '_consider', consider)


@mutation('has a timer go off although it was cleared')
def _uncleared_timers() -> Any:
    def set_timer(self: Any, timer: str, seconds: float) -> None:
        self._scheduler.after(seconds, self._guard(lambda: self._put(lambda: TimerFired(timer))))

    return mock.patch.object(process.Process, '_set', set_timer)


def seeds_to_find(make: Mutation, most: int) -> tuple[int, str]:
    """Return how many seeds it takes to find a fault, and the promise that it breaks; 0 if none of them does."""
    with make():
        for seed in range(most):
            found = run(seed).violation
            if found:
                return seed + 1, found
    return 0, ''


def table(most: int) -> Iterator[str]:
    """Return the lines of a table of all faults."""
    yield '| the learner, or a teacher, ... | seeds | what the bottle says |'
    yield '|---|---|---|'
    for what, make in MUTATIONS.items():
        seeds, found = seeds_to_find(make, most)
        short = found.split(': ', 1)[-1].replace('|', ' ')[:110]
        yield f'| {what} | {seeds or f"not within {most}"} | {short} |'


def main() -> None:
    parser = argparse.ArgumentParser(prog='mutations', description=__doc__)
    parser.add_argument('--most', type=int, default=MOST_SEEDS, help='seeds after which a fault counts as not found')
    parser.add_argument('--chart', choices=MUTATIONS, help='show the course of events that one of them leads to')
    given = parser.parse_args()
    if given.chart:
        with MUTATIONS[given.chart]():
            found = next((found for found in map(run, range(given.most)) if found.violation), None)
            sys.stdout.write(f'{explain(found) if found else "not found"}\n')
        return
    for line in table(given.most):
        sys.stdout.write(f'{line}\n')
        sys.stdout.flush()


if __name__ == '__main__':
    main()
