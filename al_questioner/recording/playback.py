"""When each message of a bag is due, while somebody pauses, steps and changes the pace."""

from __future__ import annotations

import math
from collections.abc import Sequence

from al_questioner.domain import InputError
from al_questioner.recording.bags import BagMessage

SECOND = 1_000_000_000
FASTER = 1.25
"""Factor of the rate, up or down, at each wish for it."""


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
        self.rate = rate
        self.loop = loop
        self.paused = paused
        self._messages = messages
        self._next = 0
        self._stamp = messages[0].stamp
        self._since: float | None = None

    @property
    def position(self) -> int:
        """Number of messages that were handed out in this round."""
        return self._next

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
        if self.paused or self._since is None:
            return self._stamp
        moved = self._stamp + round((now - self._since) * self.rate * SECOND)
        return min(moved, self._messages[-1].stamp)

    def due(self, now: float) -> list[BagMessage]:
        """The messages that are due and were not handed out yet; the first call starts the time.

        A round that has ended begins anew with the call after the one that ended it.
        """
        if self._next == len(self._messages) and self.loop:
            self._next, self._stamp, self._since = 0, self._messages[0].stamp, now
        if self._since is None:
            self._since = now
        if self.paused:
            return []
        stamp, first = self.stamp(now), self._next
        while self._next < len(self._messages) and self._messages[self._next].stamp <= stamp:
            self._next += 1
        return list(self._messages[first : self._next])

    def wait(self, now: float) -> float | None:
        """Seconds until the next message is due; None if none will be before somebody does something."""
        if self.paused or self.done:
            return None
        if self._next == len(self._messages):
            return 0.0
        return max(0.0, (self._messages[self._next].stamp - self.stamp(now)) / SECOND / self.rate)

    def pause(self, now: float) -> None:
        """Pause, or go on where it was paused."""
        self._stamp, self._since = self.stamp(now), now
        self.paused = not self.paused

    def change_rate(self, now: float, factor: float) -> None:
        """Multiply the rate from now on."""
        self._stamp, self._since = self.stamp(now), now
        self.rate *= factor

    def step(self, now: float, turn: bool) -> list[BagMessage]:
        """Pause, and hand out the next message, or all up to the one that begins the next turn.

        Args:
            now: seconds of the steady clock.
            turn: a whole turn of the questioner, not a message.
        """
        if not self.paused:
            self.pause(now)
        if self._next == len(self._messages) and self.loop:
            self._next = 0
        first = self._next
        if first == len(self._messages):
            return []
        self._next += 1
        while turn and self._next < len(self._messages) and not begins_turn(self._messages[self._next]):
            self._next += 1
        self._stamp = self._messages[self._next - 1].stamp
        return list(self._messages[first : self._next])


def begins_turn(message: BagMessage) -> bool:
    """Whether a message is the learner's word that a turn begins."""
    return message.topic.rsplit('/', 1)[-1] == 'turn'
