"""Storages of a session log that do what a disk, or a crash, may do at the worst moment."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Sequence
from pathlib import Path

from al_questioner.event_log.storage import Event, SqliteStorage


class WatchedStorage(SqliteStorage):
    """Calls `reached` at every point of writing at which a process could end, by the point's name."""

    def __init__(self, folder: Path, head: bytes, reached: Callable[[str], None]) -> None:
        super().__init__(folder, head)
        self._reached = reached

    def write(self, events: Sequence[Event]) -> None:
        self._reached('begun')
        super().write(events)
        self._reached('written')

    def commit(self) -> None:
        super().commit()
        self._reached('committed')

    def note(self, head: bytes) -> None:
        super().note(head)
        self._reached('noted')


class UnwaitedStorage(SqliteStorage):
    """Does not wait for the disk, which a test of many logs would take long for."""

    def __init__(self, folder: Path, head: bytes) -> None:
        super().__init__(folder, head)
        self._database.execute('PRAGMA synchronous=OFF')


def killer(last: int) -> Callable[[str], None]:
    """Return a function that ends this process, as a crash would, at the write point of this number; never at 0."""
    count = 0

    def reached(_: str) -> None:
        nonlocal count
        count += 1
        if count == last:
            os.kill(os.getpid(), signal.SIGKILL)

    return reached
