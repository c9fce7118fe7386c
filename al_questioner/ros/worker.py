"""Thread that does a node's work in order, so that no callback waits for a fit or a drawing."""

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
    """A job with its time; without a job, it is the end of all work."""

    due: float
    number: int
    job: Job | None = field(compare=False)


class Worker:
    """Thread that runs jobs one at a time, by the steady clock, in the order in which they are due.

    A job that fails does not end the worker: the error is passed to `on_error`.
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
        """Run a job after a delay in seconds, or at once; ignored after the worker is stopped.

        Returns:
            A function that cancels the job; it has no effect once the job has begun.
        """
        return self._enter(job, delay)

    def inbox(self, handle: Callable[[Any], None], most: int) -> Callable[[Any], None]:
        """Return a function that queues a message for `handle`; if `most` wait already, the oldest is dropped.

        Otherwise the memory of a busy worker would fill with messages of a fast publisher, which are old when the
        worker handles them.
        """
        waiting: deque[Any] = deque(maxlen=most)
        lock = threading.Lock()

        def take() -> None:
            with lock:
                message = waiting.popleft()
            handle(message)

        def put(message: Any) -> None:
            with lock:
                # The job of the dropped message takes the next one.
                is_full = len(waiting) == most
                waiting.append(message)
            if not is_full:
                self.submit(take)

        return put

    @property
    def stopped(self) -> bool:
        """True once no more jobs are done."""
        return self._stopped

    def stop(self, timeout: float = 2.0) -> None:
        """Drop the waiting jobs and let the running one finish, for at most `timeout` seconds."""
        with self._changed:
            self._stopped = True
            self._changed.notify()
        self._thread.join(timeout)

    def finish(self, timeout: float = 30.0) -> None:
        """Do the jobs that are due, for at most `timeout` seconds, and stop."""
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
        """Wait for the next job and take it; return None once there are no more jobs."""
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
            except Exception as error:  # noqa: BLE001 - no message may end a node
                self._on_error(error)
