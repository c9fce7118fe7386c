"""Timer for one job, which can be postponed or cancelled."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.ros.worker import Cancel, Job


class OneShotTimer:
    """Timer that gives a worker one job later, see `QuestionerNode.after`. All methods are for that worker."""

    def __init__(self, after: Callable[[float, Job], Cancel], job: Job) -> None:
        self._after = after
        self._job = job
        self._cancel: Cancel | None = None

    def set(self, seconds: float) -> None:
        """Set the timer to this number of seconds from now; any earlier setting is cancelled."""
        self.clear()
        self._cancel = self._after(seconds, self._job)

    def clear(self) -> None:
        """Cancel the timer."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None
