"""When each message of a bag is due, while somebody pauses, steps and changes the pace."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from al_questioner.bags.reading import BagMessage
from al_questioner.bags.topics import is_document
from al_questioner.domain import InputError
from al_questioner.messages.stamps import SECOND

FASTER = 1.25
"""Factor of the rate, up or down, at each wish for it."""
STEP = SECOND
"""Nanoseconds by which a clock must go back to have been put back."""
SLOWEST, FASTEST = 1e-3, 1e3
"""Between these, wishes change the rate: a key that is held down must not bring the time to a stop."""


class _Pace(NamedTuple):
    """How the recorded time goes on from a moment; one object, so that every thread that looks sees a whole one.

    Attributes:
        stamp: the recorded time at that moment, nanoseconds.
        since: that moment, seconds of the steady clock; None before the first.
        rate: recorded seconds in a second.
        paused: whether it stands still.
    """

    stamp: int
    since: float | None
    rate: float
    paused: bool


class Playback:
    """A position in a bag that moves with a steady clock, which the caller reads and hands in.

    Args:
        messages: in the order in which they are to be published.
        rate: recorded seconds in a second.
        loop: begin anew at the end.
        paused: begin with a pause.

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
        self._next = 0
        self._turn = 0
        self._pace = _Pace(messages[0].stamp, None, rate, paused)
        self.turns = sum(begins_turn(message) for message in messages)

    @property
    def rate(self) -> float:
        """Recorded seconds in a second."""
        return self._pace.rate

    @property
    def paused(self) -> bool:
        """Whether the recorded time stands still."""
        return self._pace.paused

    @property
    def position(self) -> int:
        """Number of messages that were handed out in this round."""
        return self._next

    @property
    def turn(self) -> int:
        """Number of turns that have begun in this round."""
        return self._turn

    @property
    def done(self) -> bool:
        """Whether all messages were handed out and no other round follows."""
        return self._next == len(self._messages) and not self.loop

    @property
    def duration(self) -> float:
        """Seconds from the first to the last message, at rate 1."""
        return (self._messages[-1].stamp - self._messages[0].stamp) / SECOND

    def elapsed(self, now: float) -> float:
        """Recorded seconds since the first message."""
        return (self.stamp(now) - self._messages[0].stamp) / SECOND

    def stamp(self, now: float) -> int:
        """The recorded time, nanoseconds since the epoch; it stands still while paused and at the end.

        Args:
            now: seconds of the steady clock.
        """
        stamp, since, rate, paused = self._pace
        if paused or since is None:
            return stamp
        # Bounded before it is rounded: a high rate makes it infinite.
        return stamp + round(min(max(0.0, now - since) * rate * SECOND, self._messages[-1].stamp - stamp))

    def due(self, now: float) -> list[BagMessage]:
        """The messages that are due and were not handed out yet; the first call starts the time.

        A round that has ended begins anew with the call after the one that ended it, unless it is paused.
        """
        if self.paused:
            return []
        if self._next == len(self._messages) and self.loop:
            self._rewind(now)
        if self._pace.since is None:
            self._pace = self._pace._replace(since=now)
        stamp, end = self.stamp(now), self._next
        while end < len(self._messages) and self._messages[end].stamp <= stamp:
            end += 1
        return self._hand_out(end)

    def wait(self, now: float) -> float | None:
        """Seconds until the next message is due; None if none will be before somebody does something."""
        if self.paused or self.done:
            return None
        if self._next == len(self._messages):
            return 0.0
        return max(0.0, (self._messages[self._next].stamp - self.stamp(now)) / SECOND / self.rate)

    def pause(self, now: float) -> None:
        """Pause, or go on where it was paused."""
        self._pace = _Pace(self.stamp(now), now, self.rate, not self.paused)

    def change_rate(self, now: float, factor: float) -> None:
        """Multiply the rate from now on, as far as that does not lead out of SLOWEST to FASTEST."""
        wanted = self.rate * factor
        rate = max(wanted, min(self.rate, SLOWEST)) if factor < 1 else min(wanted, max(self.rate, FASTEST))
        since = None if self._pace.since is None else now
        self._pace = _Pace(self.stamp(now), since, rate, self.paused)

    def step(self, now: float, turn: bool) -> list[BagMessage]:
        """Pause, and hand out the next message, or all up to the end of the next turn.

        Args:
            now: seconds of the steady clock.
            turn: hand out what is left of this turn and the whole next one, not a message.
        """
        if not self.paused:
            self.pause(now)
        if self._next == len(self._messages) and self.loop:
            self._rewind(now)
        found = self._hand_out(self._end_of_next_turn() if turn else min(self._next + 1, len(self._messages)))
        if found:
            self._pace = self._pace._replace(stamp=found[-1].stamp)
        return found

    def _end_of_next_turn(self) -> int:
        """Where the turn after the one that comes next begins."""
        begun = False
        for at in range(self._next, len(self._messages)):
            if begins_turn(self._messages[at]):
                if begun:
                    return at
                begun = True
        return len(self._messages)

    def _hand_out(self, end: int) -> list[BagMessage]:
        found = list(self._messages[self._next : end])
        self._next = end
        self._turn += sum(map(begins_turn, found))
        return found

    def _rewind(self, now: float) -> None:
        self._next = self._turn = 0
        self._pace = self._pace._replace(stamp=self._messages[0].stamp, since=now)


def begins_turn(message: BagMessage) -> bool:
    """Whether a message is the learner's word that a turn begins."""
    return is_document(message, 'turn')


def without_steps_back(messages: Sequence[BagMessage]) -> list[BagMessage]:
    """The messages in their order, with stamps that never go back: for playing what a recorder stamped otherwise.

    Where its clock was put back the next message follows at once, and all after it keep their distances.
    """
    found: list[BagMessage] = []
    put_back = latest = 0
    for message in messages:
        stamp = message.stamp + put_back
        if stamp < latest - STEP:
            put_back += latest - stamp
        # A little out of order are messages of different topics on any clock.
        latest = max(latest, message.stamp + put_back)
        found.append(replace(message, stamp=latest))
    return found
