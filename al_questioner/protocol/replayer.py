"""Machine that plays a bag: waits for listeners, publishes what is due, obeys keys, and yields to a live learner."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple, Protocol

from al_questioner.domain import InputError
from al_questioner.protocol.effects import AwaitArrival, ClearTimer, Effects, Publish, Report, SetTimer
from al_questioner.protocol.machine import Machine

FASTER = 1.25
"""Factor of the rate, up or down, at each request for it."""
LONGEST_WAIT = 0.5
"""Seconds after which it looks again, however far away the next message is."""
POLL = 0.1
"""Seconds between two looks for listeners."""
SETTLED = 1.0
"""Seconds without a new listener after which all are taken to be there."""
LINGER = 2.0
"""Seconds for which listeners may be behind at the end."""
CLOCK = '/clock'
"""Topic of the recorded time."""
KEY = 'key'
"""Source of the keys that are pressed."""
LISTENERS, RIVALS, NEXT, TICK = 'listeners', 'rivals', 'next', 'tick'
"""Timers: looks for listeners and for a live learner, the next message, and the next time on the clock."""


class RecordedMessage(Protocol):
    """A message of a bag."""

    @property
    def topic(self) -> str:
        """Its full name in the bag."""
        ...


class Timing(Protocol):
    """Schedule of the messages of a bag; see `bags.playback.Playback`. Its `now` is in seconds of the steady clock."""

    @property
    def done(self) -> bool:
        """True once all messages were returned and no other round follows."""
        ...

    def stamp(self, now: float) -> int:
        """Return the recorded time, in nanoseconds."""
        ...

    def due(self, now: float) -> Sequence[RecordedMessage]:
        """Return the messages that are due and were not returned yet."""
        ...

    def wait(self, now: float) -> float | None:
        """Return the seconds until the next message is due; None if none is until a key is pressed."""
        ...

    def pause(self, now: float) -> None:
        """Pause, or continue after a pause."""
        ...

    def change_rate(self, now: float, factor: float) -> None:
        """Multiply the rate."""
        ...

    def step(self, now: float, turn: bool) -> Sequence[RecordedMessage]:
        """Pause, and return the next message, or the rest of this turn and the whole next one."""
        ...


class Rival(NamedTuple):
    """Another node that publishes what the replay does.

    Attributes:
        node: its full name.
        topic: full name of the topic.
    """

    node: str
    topic: str


class Surroundings(NamedTuple):
    """Questions to those who are around, each asked when its answer is needed.

    Attributes:
        count_listeners: returns the number of those who listen to what is played.
        find_rival: returns a node that publishes turns, too; None if there is none.
    """

    count_listeners: Callable[[], int]
    find_rival: Callable[[], Rival | None]


class ReplayMachine(Machine):
    """Publishes the messages of a bag, as they were recorded, when the playback says so.

    A message is published under its name in the bag, with itself as the content; the recorded time on `CLOCK`, with its
    nanoseconds as the content.

    Args:
        playback: when the messages are due.
        surroundings: who listens, and who disturbs.
        patience: seconds for which it waits for a first listener.
        clock_period: seconds from one recorded time on the clock to the next; None for no clock.

    Attributes:
        playback: as it was given.
        started: whether it waits for listeners no longer.
        over: whether there is no more to do: it was told to quit, or all is played and has arrived, or it failed.
        failure: why it must not go on.
    """

    def __init__(
        self, playback: Timing, surroundings: Surroundings, patience: float, clock_period: float | None = None
    ) -> None:
        super().__init__()
        self.playback = playback
        self.started = False
        self.over = False
        self.failure: InputError | None = None
        self._surroundings = surroundings
        self._patience = patience
        self._clock_period = clock_period
        self._next_tick = 0.0
        self._deadline = math.inf
        self._listeners = 0
        self._settled_since = 0.0
        self.on_entry(KEY, self._obey)
        self.on_timer(LISTENERS, self._await_listeners)
        self.on_timer(RIVALS, self._look_for_rivals)
        self.on_timer(NEXT, self._advance)
        self.on_timer(TICK, self._tick)

    def start(self) -> Effects:
        """Wait for listeners."""
        now = self.now.steady
        self._deadline = now + self._patience
        yield Report('waiting for listeners')
        yield SetTimer(RIVALS, POLL)
        if self._clock_period is not None:
            self._next_tick = now + self._clock_period
            yield SetTimer(TICK, self._clock_period)
        yield from self._await_listeners()

    def _obey(self, key: str) -> Effects:
        """Do what a key stands for; for an unknown one, nothing."""
        now = self.now.steady
        if self.over:
            return
        if key == ' ':
            self.playback.pause(now)
        elif key in ('right', 'n'):
            yield from self._play(self.playback.step(now, turn=True))
        elif key == 's':
            yield from self._play(self.playback.step(now, turn=False))
        elif key in ('up', 'down'):
            self.playback.change_rate(now, FASTER if key == 'up' else 1 / FASTER)
        elif key == 'q':
            self.over = True
        else:
            return
        yield from self._advance()

    def _await_listeners(self) -> Effects:
        """Begin once there are listeners and no more of them come: what is not latched would be lost to them."""
        self._yield_to_learner()
        if self.started or self.over:
            return
        now, listeners = self.now.steady, self._surroundings.count_listeners()
        if listeners != self._listeners:
            self._listeners, self._settled_since = listeners, now
        if now - self._settled_since >= SETTLED if listeners else now >= self._deadline:
            yield from self._advance()
        else:
            yield SetTimer(LISTENERS, POLL)

    def _look_for_rivals(self) -> Effects:
        yield SetTimer(RIVALS, POLL)
        self._yield_to_learner()

    def _yield_to_learner(self) -> None:
        """End if a live learner has these names: a recorded turn could replace its own before perception sees it."""
        rival = self._surroundings.find_rival()
        if rival is not None and not self.over:
            self.failure = InputError(
                f'{rival.node} publishes on {rival.topic}, too; keep the replay apart: --ros-args -r __ns:=/replay'
            )
            self.over = True

    def _advance(self) -> Effects:
        """Publish what is due, and come again for the next."""
        if self.over:
            return
        if not self.started:
            self.started = True
            yield Report('playing')
        yield from self._play(self.playback.due(self.now.steady))
        wait = self.playback.wait(self.now.steady)
        if wait is not None:
            yield SetTimer(NEXT, max(1e-4, min(wait, LONGEST_WAIT)))
            return
        yield ClearTimer(NEXT)
        if self.playback.done:
            yield from self._finish()

    def _play(self, messages: Sequence[RecordedMessage]) -> Effects:
        for message in messages:
            yield Publish(message.topic, message)

    def _finish(self) -> Effects:
        """Let the last messages arrive: they are gone with their publishers."""
        yield Report('the end of the bag')
        yield from self._tell_time()
        yield AwaitArrival(LINGER)
        self.over = True

    def _tick(self) -> Effects:
        """Tell the time, and again after a period, whatever the telling takes."""
        if self._clock_period is None:
            return
        late = max(0.0, self.now.steady - self._next_tick)
        # Ticks that were slept through are left out.
        self._next_tick += self._clock_period * (1 + late // self._clock_period)
        yield SetTimer(TICK, max(0.0, self._next_tick - self.now.steady))
        yield from self._tell_time()

    def _tell_time(self) -> Effects:
        if self._clock_period is not None:
            yield Publish(CLOCK, self.playback.stamp(self.now.steady))
