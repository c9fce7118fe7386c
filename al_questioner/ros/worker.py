"""A thread that does a node's work in order, so that no callback ever waits for a fit or a drawing."""

from __future__ import annotations

import heapq
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from typing import Any

Job = Callable[[], None]
Cancel = Callable[[], None]


@dataclass(order=True)
class _Entry:
    """A job; the end of all work if there is none."""

    due: float
    number: int
    job: Job | None = field(compare=False)


class Worker:
    """Runs jobs one at a time, by the steady clock, in the order in which they are due.

    A job that fails does not end the worker: the error is handed to `on_error`.
    """

    def __init__(self, name: str, on_error: Callable[[Exception], None]) -> None:
        self._entries: list[_Entry] = []
        self._numbers = count()
        self._changed = threading.Condition()
        self._on_error = on_error
        self._stopped = False
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def submit(self, job: Job, delay: float = 0.0) -> Cancel:
        """Have a job done, after so many seconds if not at once; ignored once the worker is stopped.

        Returns:
            A function that calls the job off, without effect once it has begun.
        """
        return self._enter(job, delay)

    def inbox(self, handle: Callable[[Any], None], most: int) -> Callable[[Any], None]:
        """Make a function that has a message handled; beyond so many that wait, the oldest of them is dropped.

        A worker that is busy for a while, beside somebody who publishes fast, would fill the memory with messages that
        are old by the time that it comes to them.
        """
        waiting: deque[Any] = deque(maxlen=most)
        lock = threading.Lock()

        def take() -> None:
            with lock:
                message = waiting.popleft()
            handle(message)

        def put(message: Any) -> None:
            with lock:
                # A job that waits for what is dropped takes the next.
                is_full = len(waiting) == most
                waiting.append(message)
            if not is_full:
                self.submit(take)

        return put

    @property
    def stopped(self) -> bool:
        """Whether no job will be done any more."""
        return self._stopped

    def stop(self, timeout: float = 2.0) -> None:
        """Drop the jobs that wait and let the running one finish, for at most `timeout` seconds."""
        with self._changed:
            self._stopped = True
            self._changed.notify()
        self._thread.join(timeout)

    def finish(self, timeout: float = 30.0) -> None:
        """Do the jobs that are due, for at most `timeout` seconds, and then no more."""
        self._enter(None, 0.0)
        self._thread.join(timeout)
        self._stopped = True

    def _enter(self, job: Job | None, delay: float) -> Cancel:
        with self._changed:
            entry = _Entry(time.monotonic() + max(0.0, delay), next(self._numbers), job)
            if not self._stopped:
                heapq.heappush(self._entries, entry)
                self._changed.notify()
        return partial(self._cancel, entry)

    def _cancel(self, entry: _Entry) -> None:
        with self._changed:
            if entry in self._entries:
                self._entries.remove(entry)
                heapq.heapify(self._entries)

    def _take(self) -> Job | None:
        """Wait for the next job and take it; None if there is none any more."""
        with self._changed:
            while not self._stopped:
                wait = self._entries[0].due - time.monotonic() if self._entries else None
                if wait is not None and wait <= 0:
                    return heapq.heappop(self._entries).job
                self._changed.wait(wait)
        return None

    def _run(self) -> None:
        while (job := self._take()) is not None:
            try:
                job()
            except Exception as error:  # noqa: BLE001 - a node never dies of a message
                self._on_error(error)
