"""Saying a thing until it is heard: again and again, and ever more rarely, by the steady clock."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Generic, TypeVar

from al_questioner.ros.node import QuestionerNode

Said = TypeVar('Said')


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


class Repeater(Generic[Said]):
    """Says one thing at a time, the same each time, until it is told to stop. All of it happens on the node's worker.

    Args:
        node: whose worker it is.
        publish: says it.
        back_off: how often.

    Attributes:
        said: what is being said; None if nothing is.
    """

    def __init__(self, node: QuestionerNode, publish: Callable[[Said], None], back_off: BackOff) -> None:
        self.said: Said | None = None
        self._node = node
        self._publish = publish
        self._back_off = back_off
        self._pause = self._due = 0.0
        # A thread waits for each timer, so there is one for all that is said, unless the next thing is due before it.
        self._wakes_at = math.inf

    def say(self, thing: Said, delay: float = 0.0) -> None:
        """Say this, in the place of what was said before: for the first time after so many seconds, if not at once."""
        self.said = thing
        self._pause = self._back_off.first
        self._due = time.monotonic() + delay
        self._go_on()

    def stop(self) -> None:
        """Say nothing any more."""
        self.said = None

    def _go_on(self) -> None:
        if self.said is None:
            return
        now = time.monotonic()
        if now >= self._due:
            self._publish(self.said)
            self._due = now + self._pause
            self._pause = min(2 * self._pause, self._back_off.longest)
        if self._due < self._wakes_at:
            self._wakes_at = self._due
            self._node.after(self._due - now, partial(self._wake, self._due))

    def _wake(self, at: float) -> None:
        # Another timer than the last one has been overtaken.
        if at == self._wakes_at:
            self._wakes_at = math.inf
            self._go_on()
