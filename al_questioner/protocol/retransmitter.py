"""Repetition of a message until it is acknowledged, at growing intervals."""

from __future__ import annotations

from dataclasses import dataclass

from al_questioner.protocol.effects import ClearTimer, Effects, Publish, SetTimer
from al_questioner.protocol.machine import Machine


@dataclass(frozen=True)
class BackOff:
    """Time between two transmissions of a message: doubled each time, up to a limit.

    Attributes:
        first: seconds from the first transmission to the second.
        longest: largest number of seconds between two transmissions.
    """

    first: float
    longest: float


PATIENT = BackOff(first=2.0, longest=30.0)
"""Intervals for a latched message, which a late subscriber receives anyway."""
PERSISTENT = BackOff(first=1.0, longest=1.0)
"""Intervals for a message that is not latched, so that a late subscriber receives it soon."""


class Retransmitter:
    """Part of a machine that repeats one message until it is stopped.

    Args:
        machine: whose part it is.
        name: of its timer.
        back_off: the intervals.

    Attributes:
        message: the message that is repeated; None if there is none.
    """

    def __init__(self, machine: Machine, name: str, back_off: BackOff) -> None:
        self.message: Publish | None = None
        self._timer = f'repeat {name}'
        self._back_off = back_off
        self._pause = 0.0
        machine.on_timer(self._timer, self._transmit)

    def send(self, message: Publish, delay: float = 0.0) -> Effects:
        """Repeat this message, in place of an earlier one: for the first time after a delay in seconds, or at once."""
        self.message = message
        self._pause = self._back_off.first
        if delay > 0:
            yield SetTimer(self._timer, delay)
        else:
            yield from self._transmit()

    def stop(self) -> Effects:
        """Stop repeating the message."""
        self.message = None
        yield ClearTimer(self._timer)

    def _transmit(self) -> Effects:
        if self.message is None:
            return
        yield self.message
        yield SetTimer(self._timer, self._pause)
        self._pause = min(2 * self._pause, self._back_off.longest)
