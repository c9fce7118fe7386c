"""Saying a thing until it is heard: again and again, and ever more rarely, by the steady clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar

from al_questioner.ros.one_shot_timer import OneShotTimer
from al_questioner.ros.worker import Cancel, Job

Message = TypeVar('Message')


@dataclass(frozen=True)
class BackOff:
    """How long to wait before a thing is said once more: each time twice as long, up to a limit.

    Attributes:
        first: seconds from the first time to the second.
        longest: seconds that are never exceeded.
    """

    first: float
    longest: float


PATIENT = BackOff(first=2.0, longest=30.0)
"""For what is latched as well, so that it takes more than a late listener to miss it."""
PERSISTENT = BackOff(first=1.0, longest=1.0)
"""For what nobody hears who comes too late."""


class Retransmitter(Generic[Message]):
    """Says one thing at a time, the same each time, until it is told to stop. All of it happens on the node's worker.

    Args:
        after: has the node's worker do a job after so many seconds, see `QuestionerNode.after`.
        publish: says it.
        back_off: how often.

    Attributes:
        said: what is being said; None if nothing is.
    """

    def __init__(
        self, after: Callable[[float, Job], Cancel], publish: Callable[[Message], None], back_off: BackOff
    ) -> None:
        self.said: Message | None = None
        self._publish = publish
        self._back_off = back_off
        self._pause = 0.0
        self._timer = OneShotTimer(after, self._go_on)

    def say(self, thing: Message, delay: float = 0.0) -> None:
        """Say this, in the place of what was said before: for the first time after so many seconds, if not at once."""
        self.said = thing
        self._pause = self._back_off.first
        if delay > 0:
            self._timer.set(delay)
        else:
            self._go_on()

    def stop(self) -> None:
        """Say nothing any more."""
        self.said = None
        self._timer.clear()

    def _go_on(self) -> None:
        if self.said is None:
            return
        self._publish(self.said)
        self._timer.set(self._pause)
        self._pause = min(2 * self._pause, self._back_off.longest)
