"""One job at a later time, by the steady clock, with one thread that waits however often the time is changed."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial

from al_questioner.ros.node import QuestionerNode


class OneShotTimer:
    """Has the node's worker do a job once its time has come. All methods are for that worker.

    Args:
        node: whose worker it is.
        job: what is to be done.
    """

    def __init__(self, node: QuestionerNode, job: Callable[[], None]) -> None:
        self._node = node
        self._job = job
        self._due = math.inf
        # A thread waits for each timer, so the next one is for all later times, unless a time before it is set.
        self._wakes_at = math.inf

    def set(self, seconds: float) -> None:
        """Go off so many seconds from now, in the place of any time that was set before."""
        self._due = time.monotonic() + seconds
        self._wait()

    def clear(self) -> None:
        """Do not go off."""
        self._due = math.inf

    def _wait(self) -> None:
        if self._due < self._wakes_at:
            self._wakes_at = self._due
            self._node.after(self._due - time.monotonic(), partial(self._wake, self._due))

    def _wake(self, at: float) -> None:
        # Another timer than the last one has been overtaken.
        if at != self._wakes_at:
            return
        self._wakes_at = math.inf
        if time.monotonic() >= self._due:
            self._due = math.inf
            self._job()
        else:
            self._wait()
