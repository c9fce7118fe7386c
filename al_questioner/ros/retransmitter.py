"""Repetition of a message until it is acknowledged, at growing intervals of the steady clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from al_questioner.ros.one_shot_timer import OneShotTimer
from al_questioner.ros.worker import Cancel, Job

Message = TypeVar('Message')


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


class Retransmitter(Generic[Message]):
    """Sender that repeats one message until it is stopped. All methods run on the worker, see `QuestionerNode.after`.

    Attributes:
        message: the message that is repeated; None if there is none.
    """

    def __init__(
        self, after: Callable[[float, Job], Cancel], publish: Callable[[Message], None], back_off: BackOff
    ) -> None:
        self.message: Message | None = None
        self._publish = publish
        self._back_off = back_off
        self._pause = 0.0
        self._timer = OneShotTimer(after, self._transmit)

    def send(self, message: Message, delay: float = 0.0) -> None:
        """Repeat this message, in place of an earlier one: for the first time after a delay in seconds, or at once."""
        self.message = message
        self._pause = self._back_off.first
        if delay > 0:
            self._timer.set(delay)
        else:
            self._transmit()

    def stop(self) -> None:
        """Stop repeating the message."""
        self.message = None
        self._timer.clear()

    def _transmit(self) -> None:
        if self.message is None:
            return
        self._publish(self.message)
        self._timer.set(self._pause)
        self._pause = min(2 * self._pause, self._back_off.longest)
