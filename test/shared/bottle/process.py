"""A process around a machine: its worker, inbox and timers, which all end with it."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from typing import Any

from al_questioner.domain import EpisodeError, InputError
from al_questioner.protocol.effects import (
    ClearTimer,
    Effect,
    End,
    Publish,
    Record,
    Refuse,
    Say,
    SetTimer,
    SyncBag,
    WriteFile,
)
from al_questioner.protocol.events import Entered, Event, Heard, Moment, Started, TimerFired
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.performing import perform_all
from al_questioner.protocol.topics import TOPICS, Delivery, PictureToDraw, Replayed, SceneShown
from shared.bottle.chart import Chart
from shared.bottle.clocks import RobotClock
from shared.bottle.faults import Faults
from shared.bottle.looks import look_of
from shared.bottle.network import Endpoint, Network
from shared.bottle.scheduler import Scheduler

SHORTEST_DOWN_S, LONGEST_DOWN_S = 0.05, 12.0
SHORTEST_WORK_S, LONGEST_WORK_S = 0.0005, 0.02
MOST_WAITING = 1000
"""Messages of a topic that is not latched, as in the nodes."""


class Died(BaseException):
    """The process was killed; no code of it may run any more."""


class Process:
    """Runs one machine after the other: when one dies, the next takes its place after a while.

    Args:
        name: of the process, with its namespace.
        make: makes the machine; it may die, or be refused its input, meanwhile.
        slowness: how much longer than usual it works.

    Attributes:
        machine: the present one; None while there is none.
        lives: how often it was started.
        takes_all: whether it handles every message of a latched topic, and not the newest alone.
        failures: why the present machine cannot go on.
        watch: told of each effect before it is performed.
        handled: told of each event when it has been handled, with the effects.
        on_death: called when it dies.
        on_failure: told why the machine cannot go on.
        convert: makes of each message what the machine hears.
        keep: writes what is to be kept.
    """

    def __init__(
        self,
        name: str,
        namespace: str,
        make: Callable[[Process], Machine],
        clock: RobotClock,
        scheduler: Scheduler,
        network: Network,
        faults: Faults,
        chart: Chart,
        slowness: float = 1.0,
    ) -> None:
        self.name, self.namespace = name, namespace
        self.machine: Machine | None = None
        self.lives = 0
        self.takes_all = False
        self.failures: list[str] = []
        self.watch: Callable[[Effect], None] = lambda _: None
        self.handled: Callable[[Event, list[Effect]], None] = lambda _, __: None
        self.on_death: Callable[[], None] = lambda: None
        self.on_failure: Callable[[str], None] = lambda _: None
        self.convert: Callable[[Any], Any] = lambda content: content
        self.keep: Callable[[Effect], None] = lambda _: None
        self._make, self._clock = make, clock
        self._scheduler, self._network, self._faults, self._chart = scheduler, network, faults, chart
        self._slowness = slowness
        self._endpoint: Endpoint | None = None
        self._boundaries = self._works = 0
        self._is_ended = False

    @property
    def is_up(self) -> bool:
        return self._endpoint is not None

    @property
    def now(self) -> Moment:
        """The time as the process reads it."""
        return Moment(self._scheduler.now, self._clock.nanoseconds)

    @property
    def waiting(self) -> int:
        """Number of messages and timers that wait."""
        return len(self._jobs) + len(self._timers) if self.is_up else 0

    def start(self) -> None:
        """Start the process, unless it runs."""
        if self.is_up or self._is_ended:
            return
        self.lives += 1
        self.failures = []
        self._jobs: deque[Callable[[], Event | None]] = deque()
        self._timers: dict[str, object] = {}
        self._is_busy = False
        self._chart.note(self.name, 'STARTS' if self.lives == 1 else 'STARTS AGAIN')
        self._endpoint = endpoint = Endpoint(self.name, self.namespace)
        try:
            self.machine = self._make(self)
        except Died:
            self._die()
            return
        except (InputError, EpisodeError) as error:
            # As a node whose parameters or files cannot be used: it ends, and somebody tries again.
            self._chart.note(self.name, f'CANNOT START: {error}')
            self._die()
            return
        for topic in self.machine.subscribes:
            endpoint.hear[topic] = self._inbox(topic)
        self._put(Started)
        self._network.join(endpoint)

    def kill(self) -> None:
        """Kill it, if it runs, in between two events."""
        if self.is_up:
            self._die()

    def end(self) -> None:
        """End it for good."""
        self._is_ended = True
        if self.is_up:
            self._leave()

    def enter(self, source: str, content: Any) -> None:
        """Have the machine handle what a person did."""
        if self.is_up:
            self._put(lambda: Entered(source, content))

    def boundary(self, where: str) -> None:
        """Die here, if a fault says so."""
        number = self._boundaries
        self._boundaries += 1
        if self._faults.happens('death', self.name, number):
            self._chart.note(self.name, f'DIES {where}')
            raise Died

    def _inbox(self, topic: str) -> Callable[[Any], None]:
        is_latched = TOPICS[topic] is Delivery.LATCHED
        most = MOST_WAITING if self.takes_all or not is_latched else 1
        waiting: deque[Any] = deque(maxlen=most)

        def take() -> Event:
            return Heard(topic, waiting.popleft())

        def put(content: Any) -> None:
            # The job of a message that is dropped takes the next one.
            is_full = len(waiting) == most
            waiting.append(self.convert(content))
            if not is_full:
                self._put(take)

        return put

    def _put(self, job: Callable[[], Event | None]) -> None:
        self._jobs.append(job)
        if not self._is_busy:
            self._is_busy = True
            self._scheduler.after(0.0, self._guard(self._work))

    def _guard(self, action: Callable[[], None]) -> Callable[[], None]:
        """Return an action that does nothing once this life is over."""
        endpoint = self._endpoint

        def run() -> None:
            if self._endpoint is endpoint:
                action()

        return run

    def _work(self) -> None:
        if not self._jobs:
            self._is_busy = False
            return
        event = self._jobs.popleft()()
        if event is None:
            self._work()
            return
        self._works += 1
        effects: list[Effect] = []
        machine = self.machine
        assert machine is not None

        def perform(effect: Effect) -> None:
            self.boundary(f'before {type(effect).__name__}')
            effects.append(effect)
            self.watch(effect)
            self._perform(effect)

        try:
            perform_all(machine.handle(event, self.now), perform)
            self.boundary('between two events')
        except Died:
            self._die()
            return
        except (EpisodeError, InputError) as error:
            # As the nodes do: the failure is shown, the process stays.
            self._chart.note(self.name, f'FAILS: {error}')
            self.failures.append(str(error))
            self.on_failure(str(error))
        self.handled(event, effects)
        if self.is_up:
            share = self._faults.draw('work', self.name, self._works)
            took = self._slowness * (SHORTEST_WORK_S + (LONGEST_WORK_S - SHORTEST_WORK_S) * share**4)
            self._scheduler.after(took, self._guard(self._work))

    def _perform(self, effect: Effect) -> None:
        if isinstance(effect, Publish):
            assert self._endpoint is not None
            content = effect.content
            if isinstance(content, SceneShown):
                content = look_of(content.scene, content.stamp)
            elif isinstance(content, Replayed):
                content = look_of(content.data, content.stamp)
            elif isinstance(content, PictureToDraw):
                content = content.drawn()
            self._network.publish(self._endpoint, effect.topic, content)
        elif isinstance(effect, SetTimer):
            self._set(effect.timer, effect.seconds)
        elif isinstance(effect, ClearTimer):
            self._timers.pop(effect.timer, None)
        elif isinstance(effect, Refuse):
            self._chart.note(self.name, f'refuses on {effect.topic}: {effect.reason[:100]}')
        elif isinstance(effect, Say):
            self._chart.note(self.name, f'says: {effect.text[:100]}')
        elif isinstance(effect, End):
            self.end()
        elif isinstance(effect, (Record, SyncBag, WriteFile)):
            self.keep(effect)

    def _set(self, timer: str, seconds: float) -> None:
        token = self._timers[timer] = object()

        def ring() -> None:
            if self._timers.get(timer) is token:
                self._put(lambda: self._ringing(timer, token))

        self._scheduler.after(seconds, self._guard(ring))

    def _ringing(self, timer: str, token: object) -> Event | None:
        # It may have been cleared, or set again, while its ring waited for the worker.
        return TimerFired(timer) if self._timers.get(timer) is token and self._timers.pop(timer) else None

    def _leave(self) -> None:
        endpoint, self._endpoint, self.machine = self._endpoint, None, None
        if endpoint is not None and endpoint in self._network.endpoints:
            self._network.leave(endpoint)

    def _die(self) -> None:
        self._leave()
        self.on_death()
        share = self._faults.draw('down', self.name, self.lives)
        down = SHORTEST_DOWN_S + (LONGEST_DOWN_S - SHORTEST_DOWN_S) * share**3
        self._scheduler.after(down, self.start)
