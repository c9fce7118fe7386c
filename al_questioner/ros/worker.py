"""A thread that does a node's work in order, so that no callback ever waits for a fit or a drawing."""

from __future__ import annotations

import queue
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

Job = Callable[[], None]


class Worker:
    """Runs jobs one at a time, in the order they were submitted.

    A job that fails does not end the worker: the error is handed to `on_error`.
    """

    def __init__(self, name: str, on_error: Callable[[Exception], None]) -> None:
        self._jobs: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._on_error = on_error
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)
        self._thread.start()

    def submit(self, job: Job) -> None:
        """Have a job done; ignored once the worker is stopped."""
        if not self._stopped.is_set():
            self._jobs.put(job)

    def inbox(self, handle: Callable[[Any], None], most: int) -> Callable[[Any], None]:
        """A function that has a message handled; beyond so many that wait, the oldest of them is dropped.

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
        return self._stopped.is_set()

    def stop(self, timeout: float = 2.0) -> None:
        """Drop the jobs that wait and let the running one finish, for at most `timeout` seconds."""
        self._stopped.set()
        self._jobs.put(None)
        self._thread.join(timeout)

    def finish(self, timeout: float = 30.0) -> None:
        """Do the jobs that wait, for at most `timeout` seconds, and then no more."""
        self._jobs.put(None)
        self._thread.join(timeout)
        self._stopped.set()

    def _run(self) -> None:
        while True:
            job = self._jobs.get()
            if job is None or self._stopped.is_set():
                return
            try:
                job()
            except Exception as error:  # noqa: BLE001 - a node never dies of a message
                self._on_error(error)
