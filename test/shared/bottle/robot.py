"""One robot: a learner with its disk, its perception and its teachers, in a namespace of its own."""

from __future__ import annotations

from dataclasses import dataclass

from al_questioner.domain import AUTO, EpisodeSettings
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.protocol.events import Event
from al_questioner.protocol.effects import Effect
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.protocol.machine import Machine
from al_questioner.questioning import make_strategy
from shared.bottle.chart import Chart
from shared.bottle.clocks import RobotClock
from shared.bottle.faults import Faults
from shared.bottle.network import Network
from shared.bottle.people import Person
from shared.bottle.process import Process
from shared.bottle.promises import Promises
from shared.bottle.scheduler import Scheduler
from shared.bottle.sensors import Camera, TurnPerception
from shared.bottle.table import SYMBOLS, Table

STRATEGIES = ('random_fsq', 'farthest_fsq', 'rarest_demo', 'u_sampling_fsq')
"""Strategies that never ask again about a thing that they know, and are quick."""
SECONDS_OF_A_FULL_DISK = 8.0
SECONDS_BETWEEN_LOOKS = 4.0


@dataclass(frozen=True)
class Plan:
    """Layout of a robot.

    Attributes:
        noise: of its camera; None if it has the perception that answers turns.
        people: for each teacher, whether they speak plainly.
    """

    seed: int
    strategy: str
    turns: int
    budget: float
    things: int
    interval: int
    noise: float | None
    people: tuple[bool, ...]
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
        self._plan, self._scheduler, self._faults, self._chart = plan, scheduler, faults, chart
        self._namespace = namespace
        self._table = Table(plan.seed, plan.things, plan.noise or 0.0)
        self.clock = RobotClock(namespace, scheduler, faults)
        self.people = [
            Person(f'{namespace}/person{i}', namespace, self._table.symbol, plain, scheduler, network, faults, chart)
            for i, plain in enumerate(plan.people)
        ]
        self.promises = Promises(namespace, self._table, self.people, faults, replay_rate)
        self.learner = self._process('learner', self._make_learner, network)
        self.learner.watch = self.promises.watch
        self.learner.handled = self._handled
        self.learner.on_death = self._release
        if plan.noise is None:
            TurnPerception(
                f'{namespace}/perception', namespace, self._table, plan.interval, scheduler, network, faults, chart
            )
        else:
            Camera(f'{namespace}/camera', namespace, self._table, self.clock, scheduler, network, faults, chart)
        self._looks = 0
        scheduler.after(0.1 * faults.draw('start', namespace), self.learner.start)
        scheduler.after(SECONDS_BETWEEN_LOOKS, self._look_at_disk)

    def calm(self) -> None:
        """Put everything right: no fault is to happen any more."""
        self.clock.set_right()
        self.promises.disk.fault = ''
        for person in self.people:
            person.come_back()
        if self._needs_a_start():
            self.learner.kill()
        self.learner.start()

    def _process(self, name: str, make: object, network: Network) -> Process:
        return Process(
            f'{self._namespace}/{name}', self._namespace, make, self.clock, self._scheduler, network, self._faults,
            self._chart, self._plan.slowness,
        )  # fmt: skip

    def _make_learner(self, process: Process) -> Machine:
        plan = self._plan
        settings = EpisodeSettings(SYMBOLS, plan.budget, plan.turns, plan.strategy, change_interval=plan.interval)
        started = EpisodeStarted(f'{self._namespace}-e', settings, plan.seed, AUTO, None, 'x')
        self.promises.started = started
        strategy = make_strategy(settings.strategy, settings.weights)
        log = self.promises.disk.open(process.boundary)
        try:
            durable = DurableEpisode(started, strategy, log)
        except BaseException:
            log.close()
            raise
        return LearnerMachine(durable, None, LearnerOptions(plan.turn_period, plan.answer_timeout))

    def _handled(self, event: Event, effects: list[Effect]) -> None:
        machine = self.learner.machine
        is_ready = isinstance(machine, LearnerMachine) and machine.is_ready and not machine.has_failed
        self.promises.watch_handled(event, effects, is_ready)

    def _release(self) -> None:
        """Let go of the log, as the lock of a process ends with it."""
        self.promises.disk.is_locked = False

    def _needs_a_start(self) -> bool:
        machine = self.learner.machine
        return isinstance(machine, LearnerMachine) and machine.has_failed

    def _look_at_disk(self) -> None:
        """Have faults happen to the disk, and people see to a learner that could not write."""
        if not self._faults.active:
            return
        self._looks += 1
        disk, name = self.promises.disk, (self._namespace, self._looks)
        self._scheduler.after(SECONDS_BETWEEN_LOOKS, self._look_at_disk)
        if disk.fault:
            disk.fault = ''
        elif self._needs_a_start():
            self.learner.kill()
        elif self._faults.happens('disk full', *name):
            disk.fault = 'No space left on device'
        elif self._faults.happens('disk read-only', *name):
            disk.fault = 'Read-only file system'
        if disk.fault:
            self._chart.note(self._namespace, f'DISK: {disk.fault}')
