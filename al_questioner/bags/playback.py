"""Timing of the messages of a bag, with pauses, steps and changes of the pace."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import islice
from typing import NamedTuple

from al_questioner.bags.reading import BagMessage
from al_questioner.bags.topics import is_document
from al_questioner.domain import InputError
from al_questioner.messages.stamps import SECOND

STEP = SECOND
"""Smallest step back of a clock, in nanoseconds, that means that the clock was set back."""
SLOWEST, FASTEST = 1e-3, 1e3
"""Limits of the rate that requests can reach, so that a key that is held down cannot stop the time."""


class _Pace(NamedTuple):
    """Progress of the recorded time from a moment on; one object, so that every thread reads a consistent state.

    Attributes:
        stamp: the recorded time at that moment, nanoseconds.
        since: that moment, seconds of the steady clock; None before the first.
        rate: recorded seconds in a second.
        paused: whether the recorded time stands still.
    """

    stamp: int
    since: float | None
    rate: float
    paused: bool


class Playback:
    """A position in a bag that moves with a steady clock, whose seconds the caller reads and passes in as `now`.

    Messages are published in the order given, at a rate of recorded seconds in a second.

    Attributes:
        position: number of messages that were returned in this round.
        turn: number of turns that have begun in this round, of `turns` that a round has.

    Raises:
        InputError: no message, or a rate that is not a number above 0.
    """

    def __init__(
        self, messages: Sequence[BagMessage], rate: float = 1.0, loop: bool = False, paused: bool = False
    ) -> None:
        if not messages:
            raise InputError('there is nothing to play')
        if not (math.isfinite(rate) and rate > 0):
            raise InputError(f'rate must be a number above 0, not {rate}')
        self.loop = loop
        self._messages = messages
        self.position = 0
        self.turn = 0
        self._pace = _Pace(messages[0].stamp, None, rate, paused)
        self.turns = sum(begins_turn(message) for message in messages)

    @property
    def rate(self) -> float:
        """Recorded seconds in a second."""
        return self._pace.rate

    @property
    def paused(self) -> bool:
        """True while the recorded time stands still."""
        return self._pace.paused

    @property
    def done(self) -> bool:
        """True once all messages were returned and no other round follows."""
        return self.position == len(self._messages) and not self.loop

    @property
    def duration(self) -> float:
        """Seconds from the first to the last message, at rate 1."""
        return (self._messages[-1].stamp - self._messages[0].stamp) / SECOND

    def elapsed(self, now: float) -> float:
        """Return the recorded seconds since the first message."""
        return (self.stamp(now) - self._messages[0].stamp) / SECOND

    def stamp(self, now: float) -> int:
        """Return the recorded time, nanoseconds since the epoch; it stands still while paused and at the end."""
        stamp, since, rate, paused = self._pace
        if paused or since is None:
            return stamp
        # Bounded before rounding: at a high rate the product is infinite.
        return stamp + round(min(max(0.0, now - since) * rate * SECOND, self._messages[-1].stamp - stamp))

    def due(self, now: float) -> list[BagMessage]:
        """Return the messages that are due and were not returned yet; the first call starts the time.

        The call after the one that ended a round begins a new round, unless it is paused.
        """
        if self.paused:
            return []
        if self.position == len(self._messages) and self.loop:
            self._rewind(now)
        if self._pace.since is None:
            self._pace = self._pace._replace(since=now)
        stamp, end = self.stamp(now), self.position
        while end < len(self._messages) and self._messages[end].stamp <= stamp:
            end += 1
        return self._hand_out(end)

    def wait(self, now: float) -> float | None:
        """Return the seconds until the next message is due; None if there is none until the user does something."""
        if self.paused or self.done:
            return None
        if self.position == len(self._messages):
            return 0.0
        return max(0.0, (self._messages[self.position].stamp - self.stamp(now)) / SECOND / self.rate)

    def pause(self, now: float) -> None:
        """Pause, or continue after a pause."""
        self._pace = _Pace(self.stamp(now), now, self.rate, not self.paused)

    def change_rate(self, now: float, factor: float) -> None:
        """Multiply the rate from now on; the limits are SLOWEST and FASTEST."""
        wanted = self.rate * factor
        rate = max(wanted, min(self.rate, SLOWEST)) if factor < 1 else min(wanted, max(self.rate, FASTEST))
        since = None if self._pace.since is None else now
        self._pace = _Pace(self.stamp(now), since, rate, self.paused)

    def step(self, now: float, turn: bool) -> list[BagMessage]:
        """Pause, and return the next message, or the rest of this turn and the whole next one."""
        if not self.paused:
            self.pause(now)
        if self.position == len(self._messages) and self.loop:
            self._rewind(now)
        found = self._hand_out(self._end_of_next_turn() if turn else min(self.position + 1, len(self._messages)))
        if found:
            self._pace = self._pace._replace(stamp=found[-1].stamp)
        return found

    def _end_of_next_turn(self) -> int:
        """Return the index of the message that begins the turn after the next one."""
        begins = (at for at in range(self.position, len(self._messages)) if begins_turn(self._messages[at]))
        return next(islice(begins, 1, None), len(self._messages))

    def _hand_out(self, end: int) -> list[BagMessage]:
        found = list(self._messages[self.position : end])
        self.position = end
        self.turn += sum(map(begins_turn, found))
        return found

    def _rewind(self, now: float) -> None:
        self.position = self.turn = 0
        self._pace = self._pace._replace(stamp=self._messages[0].stamp, since=now)


def begins_turn(message: BagMessage) -> bool:
    """Return whether a message of the learner begins a turn."""
    return is_document(message, 'turn')


def without_steps_back(messages: Sequence[BagMessage]) -> list[BagMessage]:
    """Return the messages in their order, with stamps that never go back, so that they can be played.

    After each step back of the recorder's clock the next message follows at once, and all later ones keep their
    distances.
    """
    found: list[BagMessage] = []
    put_back = latest = 0
    for message in messages:
        stamp = message.stamp + put_back
        if stamp < latest - STEP:
            put_back += latest - stamp
        # Messages of different topics may be a little out of order on any clock.
        latest = max(latest, message.stamp + put_back)
        found.append(replace(message, stamp=latest))
    return found
