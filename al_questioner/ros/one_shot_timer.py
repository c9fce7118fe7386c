"""One job at a later time, which can be put off or called off."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.ros.worker import Cancel, Job


class OneShotTimer:
    """Has a worker do a job once its time has come. All methods are for that worker.

    Args:
        after: has the worker do a job after so many seconds, see `QuestionerNode.after`.
        job: what is to be done.
    """

    def __init__(self, after: Callable[[float, Job], Cancel], job: Job) -> None:
        self._after = after
        self._job = job
        self._cancel: Cancel | None = None

    def set(self, seconds: float) -> None:
        """Go off so many seconds from now, in the place of any time that was set before."""
        self.clear()
        self._cancel = self._after(seconds, self._job)

    def clear(self) -> None:
        """Do not go off."""
        if self._cancel is not None:
            self._cancel()
            self._cancel = None
