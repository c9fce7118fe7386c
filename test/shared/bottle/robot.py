"""One robot: a learner with its disk, its perception, its teachers and others beside it, in one namespace."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from al_questioner.domain import AUTO, EpisodeSettings, InputError
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.protocol.effects import Effect, Publish, Record, SyncBag, WriteFile
from al_questioner.protocol.events import Event, Heard
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.recorder import RecorderMachine
from al_questioner.protocol.topics import Recorded
from al_questioner.questioning import make_strategy
from shared.bottle.chart import Chart
from shared.bottle.clocks import RobotClock
from shared.bottle.faults import Faults
from shared.bottle.network import Network
from shared.bottle.nodes import (
    Bag,
    PersonAtTerminal,
    SeenTable,
    failure_of,
    make_perception,
    make_recogniser,
    make_replay,
    make_rival,
    make_scripted_teacher,
)
from shared.bottle.people import Person
from shared.bottle.process import Process
from shared.bottle.promises import Promises
from shared.bottle.scheduler import Scheduler
from shared.bottle.sensors import Camera
from shared.bottle.table import SYMBOLS, Table

STRATEGIES = ('random_fsq', 'farthest_fsq', 'rarest_demo', 'u_sampling_fsq')
"""Strategies that never ask again about a thing that they know, and are quick."""
SECONDS_BETWEEN_LOOKS = 4.0
"""Seconds from one time at which something may happen to a disk to the next."""
SHARE_OF_LOOKS = 0.3
"""Chance, each of these times, that somebody notices what could not write, and starts it again."""
SECONDS_TO_ACKNOWLEDGE = 20.0
"""Seconds without faults within which somebody is told what came of their answer."""
MOST_WAITING = 100
"""Messages and timers that may wait for a learner at most."""
RECORDED = ('episode', 'turn', 'query', 'answer', 'answer_ack', 'learner_state')


@dataclass(frozen=True)
class Plan:
    """Layout of a robot.

    Attributes:
        noise: of its camera; None if it has the perception that answers turns.
        people: for each teacher who answers by documents or by plain words, whether it is plain words.
        others: who else is there: `script`, `terminal`, `recogniser`, `recorder`, `rival`; `replay`: a bag shows
            its scenes in place of perception.
        keeps_log: whether its learner has a session; one without begins another episode when it comes back.
        slowness: how much longer than usual its processes take.
    """

    seed: int
    strategy: str
    turns: int
    budget: float
    things: int
    interval: int
    noise: float | None
    people: tuple[bool, ...]
    others: frozenset[str]
    keeps_log: bool
    answer_timeout: float
    turn_period: float
    slowness: float


class Robot:
    """The processes and people of one namespace.

    Attributes:
        promises: of its learner.
        learner: its process.
    """

    def __init__(
        self,
        namespace: str,
        plan: Plan,
        scheduler: Scheduler,
        network: Network,
        faults: Faults,
        chart: Chart,
        replay_rate: float,
    ) -> None:
        self._plan, self._namespace = plan, namespace
        self._scheduler, self._network, self._faults, self._chart = scheduler, network, faults, chart
        self._table = Table(plan.seed, plan.things, plan.noise or 0.0)
        self._seen = SeenTable(self._table, plan.interval)
        self._clock = RobotClock(namespace, scheduler, faults)
        self._camera_clock = RobotClock(f'{namespace}/camera', scheduler, faults)
        # A learner that knows of no turns before may take what is latched since before a clock went back.
        shows_turns = plan.noise is None and 'rival' not in plan.others and plan.keeps_log
        self.promises = Promises(
            namespace, self._table, self._seen.number if shows_turns else None, faults, replay_rate
        )
        self.processes: list[Process] = []
        self.learner = self._process('learner', self._make_learner)
        self.learner.watch = self._watch_learner
        self.learner.handled = self._handled
        self.learner.on_death = self._release
        self.learner.keep = self._write_concepts
        self._people = [
            Person(
                f'{namespace}/person{i}', namespace, self._table.symbol, plain, self.promises.note_said,
                scheduler, network, faults, chart,
            )
            for i, plain in enumerate(plan.people)
        ]  # fmt: skip
        self.bag = Bag()
        self._had_faulty_disk = False
        self._rival: Process | None = None
        self._add_perception()
        self._add_others()
        self._looks = 0
        scheduler.after(SECONDS_BETWEEN_LOOKS, self._look_at_disks)

    def calm(self) -> None:
        """Put everything right: no fault is to happen any more."""
        self._clock.set_right()
        self._camera_clock.set_right()
        self.promises.disk.fault = self.bag.fault = ''
        for person in self._people:
            person.come_back()
        if self._rival is not None:
            self._rival.end()
        for process in self.processes:
            if process.failures and process.is_up:
                process.kill()
            process.start()

    def check_end(self) -> None:
        """Hold what is there at the end against what was promised."""
        self.promises.check_end()
        for person in self._people:
            left = person.unacknowledged(self.promises.episode_id, SECONDS_TO_ACKNOWLEDGE)
            self.promises.demand(not left, f'{person.name} was never told what became of {left}')
        unheard = [each for each in self.bag.kept if each not in self._network.published]
        self.promises.demand(not unheard, f'the recorder has what nobody said: {unheard[:1]}')
        for process in self.processes:
            machine = process.machine
            if isinstance(machine, RecorderMachine) and machine.failure is None:
                self.promises.demand(
                    machine.counts()['turns missed'] == sum(map(missing, self._heard_turns.values())),
                    f'the recorder says that it missed {machine.counts()["turns missed"]} of {self._heard_turns}',
                )

    def _process(self, name: str, make: Callable[[Process], Machine]) -> Process:
        process = Process(
            f'{self._namespace}/{name}', self._namespace, make, self._clock, self._scheduler, self._network,
            self._faults, self._chart, self._plan.slowness,
        )  # fmt: skip
        process.on_failure = partial(self._note_failure, process)
        self.processes.append(process)
        self._scheduler.after(0.1 * self._faults.draw('start', process.name), process.start)
        return process

    def _add_perception(self) -> None:
        if self._plan.noise is None:
            is_replay = 'replay' in self._plan.others
            shows = make_replay(self._seen, self._plan.turns) if is_replay else make_perception(self._seen)
            self._process('perception', shows)
        else:
            Camera(
                f'{self._namespace}/camera', self._namespace, self._table, self._camera_clock, self._scheduler,
                self._network, self._faults, self._chart,
            )  # fmt: skip

    def _add_others(self) -> None:
        plan, others = self._plan, self._plan.others
        if 'script' in others and plan.noise is None:
            teacher = self._process('teacher', make_scripted_teacher(self._seen, plan.seed, 0.3))
            teacher.watch = self._note_script
            self._watch_sender(teacher)
        if 'terminal' in others:
            person = PersonAtTerminal(
                f'{self._namespace}/terminal',
                self._table.symbol,
                self._scheduler,
                self._faults,
                self.promises.note_answer_said,
            )
            self._watch_sender(self._process('terminal', person.make_machine))
        if 'recogniser' in others:
            self._process('recogniser', make_recogniser)
        if 'recorder' in others:
            recorder = self._process('recorder', self._make_recorder)
            recorder.convert = lambda content: Recorded(content.encode(), 0, lambda: content)
            recorder.takes_all = True
            recorder.keep = self._record
            recorder.on_death = self.bag.lose
        if 'rival' in others:
            self._rival = self._process('rival', make_rival(f'{self._namespace}-rival', plan.seed))

    def _make_learner(self, process: Process) -> Machine:
        plan = self._plan
        settings = EpisodeSettings(SYMBOLS, plan.budget, plan.turns, plan.strategy, change_interval=plan.interval)
        if not plan.keeps_log:
            self.promises.forget()
        episode_id = f'{self._namespace}-e' if plan.keeps_log else f'{self._namespace}-e{process.lives}'
        started = EpisodeStarted(episode_id, settings, plan.seed, AUTO, None, 'x')
        self.promises.started = started
        strategy = make_strategy(settings.strategy, settings.weights)
        # One without a session has a log all the same, by which it is watched, and which is gone with it.
        log = self.promises.disk.open(process.boundary)
        try:
            durable = DurableEpisode(started, strategy, log)
        except BaseException:
            log.close()
            raise
        files = (Path('concepts.json'),)
        return LearnerMachine(
            durable, None, LearnerOptions(plan.turn_period, plan.answer_timeout, concepts_files=files)
        )

    def _write_concepts(self, effect: Effect) -> None:
        if isinstance(effect, WriteFile) and self.promises.disk.fault:
            raise InputError(f'{effect.path} cannot be written ({self.promises.disk.fault})')

    def _watch_learner(self, effect: Effect) -> None:
        machine = self.learner.machine
        self.promises.watch(effect, isinstance(machine, LearnerMachine) and machine.has_failed)

    def _make_recorder(self, _: Process) -> Machine:
        self._heard_turns: dict[str, list[int]] = {}
        return RecorderMachine(Path('bag'), {topic: topic for topic in RECORDED}, False, failure_of)

    def _record(self, effect: Effect) -> None:
        if isinstance(effect, Record):
            self.bag.write(effect.topic, effect.data)
            if effect.topic == 'turn':
                turn = json.loads(effect.data)
                self._heard_turns.setdefault(turn['episode_id'], []).append(turn['turn'])
        elif isinstance(effect, SyncBag):
            self.bag.sync()

    def _watch_sender(self, teacher: Process) -> None:
        """Look at whether a teacher goes on sending what was acknowledged to it."""
        acknowledged: set[str] = set()
        before = teacher.watch

        def watch(effect: Effect) -> None:
            before(effect)
            if isinstance(effect, Publish) and effect.topic == 'answer':
                answer_id = json.loads(effect.content)['answer_id']
                is_new = answer_id not in acknowledged
                self.promises.demand(is_new, f'{teacher.name} sends {answer_id} on, which was acknowledged to it')

        def note(event: Event, _: list[Effect]) -> None:
            if isinstance(event, Heard) and event.topic == 'answer_ack':
                ack, machine = json.loads(event.content), teacher.machine
                if machine is not None and ack['episode_id'] == machine.episode_id and ack['answer_id']:
                    acknowledged.add(ack['answer_id'])
            elif isinstance(event, Heard) and event.topic == 'query':
                # Who is asked again says it again.
                acknowledged.clear()

        teacher.watch, teacher.handled, teacher.on_death = watch, note, acknowledged.clear

    def _note_script(self, effect: Effect) -> None:
        """Take note of what the script says, which says one thing to each query."""
        if isinstance(effect, Publish) and effect.topic == 'answer':
            self.promises.note_said(effect.content)
            answer: dict[str, Any] = json.loads(effect.content)
            self.promises.demand(
                answer['answer_id'] == f'{answer["query_id"]}/scripted',
                f'the script answers {answer["query_id"]} under another id: {answer["answer_id"]}',
            )

    def _handled(self, event: Event, effects: list[Effect]) -> None:
        machine = self.learner.machine
        is_ready = isinstance(machine, LearnerMachine) and machine.is_ready and not machine.has_failed
        garbage: set[str] = set().union(*(person.garbage for person in self._people))
        self.promises.watch_handled(event, effects, is_ready, garbage)
        waiting = self.learner.waiting
        self.promises.demand(waiting <= MOST_WAITING, f'{waiting} messages and timers wait')
        if isinstance(machine, LearnerMachine):
            self.promises.watch_rival(event, machine.warning(self.learner.now), self.promises.is_done)

    def _release(self) -> None:
        """Let go of the log, as the lock of a process ends with it."""
        self.promises.disk.is_locked = False

    def _note_failure(self, process: Process, reason: str) -> None:
        """Look at whether a process had a reason to fail."""
        self.promises.demand(self._had_faulty_disk, f'{process.name} fails although its disk is whole: {reason}')

    def _look_at_disks(self) -> None:
        """Have faults happen to the disks, and people see to processes that could not write."""
        if not self._faults.active:
            return
        self._looks += 1
        self._scheduler.after(SECONDS_BETWEEN_LOOKS, self._look_at_disks)
        disk, name = self.promises.disk, (self._namespace, self._looks)
        was_faulty = bool(disk.fault)
        disk.fault = self.bag.fault = ''
        # What could not be written shows in what is said soon after.
        self.promises.is_suspicious = was_faulty or bool(self.learner.failures)
        if was_faulty:
            return
        if self._faults.happens('disk full', *name):
            disk.fault = self.bag.fault = 'No space left on device'
        elif self._faults.happens('disk read-only', *name):
            disk.fault = self.bag.fault = 'Read-only file system'
        elif self._faults.draw('somebody looks', *name) < SHARE_OF_LOOKS:
            for process in self.processes:
                if process.failures and process.is_up:
                    process.kill()
        if disk.fault:
            self._had_faulty_disk = self.promises.is_suspicious = True
            self._chart.note(self._namespace, f'DISK: {disk.fault}')


def missing(turns: list[int]) -> int:
    """Return how many turns up to the last one are not among those that were heard, in the order of their numbers."""
    missed, before = 0, 0
    for turn in turns:
        missed += max(0, turn - before - 1)
        before = max(turn, before)
    return missed
