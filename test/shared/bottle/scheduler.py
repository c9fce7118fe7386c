"""Virtual time: what is to happen, in the order of its time."""

from __future__ import annotations

import heapq
from collections.abc import Callable
from itertools import count


class Scheduler:
    """Runs actions at their times; of those of one time, the one that was asked for first.

    Attributes:
        now: seconds since the beginning.
        steps: actions that were run.
    """

    def __init__(self) -> None:
        self.now = 0.0
        self.steps = 0
        self._entries: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = count()

    def after(self, seconds: float, action: Callable[[], None]) -> None:
        heapq.heappush(self._entries, (self.now + max(0.0, seconds), next(self._numbers), action))

    def step(self) -> bool:
        """Run the next action; False if there is none."""
        if not self._entries:
            return False
        self.now, _, action = heapq.heappop(self._entries)
        self.steps += 1
        action()
        return True
