"""A disk that keeps what was synced and nothing else, fills up, turns read-only, and is there when a process dies."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from al_questioner.event_log.log import LogWriteError, SessionLogError
from al_questioner.event_log.storage import Event

Boundary = Callable[[str], None]
"""Called at each point of writing at which a process could die."""


class Disk:
    """The part of a session's log that outlives the processes that write it.

    Attributes:
        events: those that were synced.
        fault: why nothing can be written at present; empty if it can.
        is_locked: whether a process has the log open.
    """

    def __init__(self, committed: Callable[[list[Event]], None]) -> None:
        self.events: list[Event] = []
        self.fault = ''
        self.is_locked = False
        self._committed = committed

    def open(self, boundary: Boundary) -> SimulatedLog:
        """Open the log, as `SessionLog` does.

        Raises:
            SessionLogError: another process has it open, or it cannot be written to.
        """
        if self.is_locked:
            raise SessionLogError('another process is using this session')
        if self.fault:
            raise SessionLogError(f'the session log cannot be used ({self.fault})')
        self.is_locked = True
        return SimulatedLog(self, boundary)

    def sync(self, events: list[Event]) -> None:
        self.events += events
        self._committed(events)


class SimulatedLog:
    """Stands for a `SessionLog` on a simulated disk."""

    folder = Path('session')

    def __init__(self, disk: Disk, boundary: Boundary) -> None:
        self.events = tuple(disk.events)
        self._disk, self._boundary = disk, boundary
        self._failure = ''

    def append(self, *entries: tuple[str, bytes]) -> None:
        if self._failure:
            raise LogWriteError(self._failure)
        number = len(self._disk.events)
        events = [Event(number + i, kind, 0, content, b'') for i, (kind, content) in enumerate(entries, start=1)]
        self._boundary('before a write')
        if self._disk.fault:
            self._failure = f'the session log cannot be written ({self._disk.fault})'
            raise LogWriteError(self._failure)
        # What dies here leaves nothing: SQLite brings all of a transaction to the disk, or none.
        self._boundary('between write and sync')
        self._disk.sync(events)
        self._boundary('after a sync')

    def close(self) -> None:
        self._failure = self._failure or 'the session log is closed'
        self._disk.is_locked = False
