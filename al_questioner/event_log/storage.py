"""Storage of a log: events, which are written all or not at all, and a head that names the last one."""

from __future__ import annotations

import contextlib
import errno
import os
import sqlite3
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple, Protocol

from al_questioner.support.files import sync_to_disk

DATABASE, HEAD = 'session.sqlite3', 'session.head'

_TABLE = (
    'CREATE TABLE IF NOT EXISTS events'
    ' (number INTEGER PRIMARY KEY, kind TEXT, stamp INTEGER, content BLOB, checksum BLOB)'
)


class Event(NamedTuple):
    """One line of a log.

    Attributes:
        number: 1 for the first.
        stamp: when it was written, nanoseconds since the epoch.
        checksum: SHA-256 over it and the checksum before.
    """

    number: int
    kind: str
    stamp: int
    content: bytes
    checksum: bytes


class Storage(Protocol):
    """Storage of a log; an OSError or sqlite3.Error says that it cannot be written."""

    def write(self, events: Sequence[Event]) -> None:
        """Write events that do not count before they are committed."""
        ...

    def commit(self) -> None:
        """Bring what was written to the disk."""
        ...

    def rollback(self) -> None:
        """Forget what was written and not committed."""
        ...

    def note(self, head: bytes) -> None:
        """Replace the head. The disk is not waited for: a head that lags behind is still one of this log."""
        ...

    def close(self) -> None:
        """Let go of the files."""
        ...


StorageFactory = Callable[[Path, bytes], Storage]
"""Opens the storage in a folder, and makes it with this head if it is not there."""


class SqliteStorage:
    """A database that is written ahead, and a file for the head, in the folder of the log."""

    def __init__(self, folder: Path, head: bytes) -> None:
        with contextlib.ExitStack() as stack:
            # The head first: a database without one has lost it.
            self._head = os.open(folder / HEAD, os.O_RDWR | os.O_CREAT, 0o644)
            stack.callback(os.close, self._head)
            self._write_head(head)
            os.fsync(self._head)
            self._database = sqlite3.connect(folder / DATABASE, isolation_level=None, check_same_thread=False)
            stack.callback(self._database.close)
            self._database.execute('PRAGMA journal_mode=WAL')
            # A commit waits until the disk has it.
            self._database.execute('PRAGMA synchronous=FULL')
            self._database.execute(_TABLE)
            for path in (folder, folder.absolute().parent):
                sync_to_disk(path)
            self._open = stack.pop_all()

    def write(self, events: Sequence[Event]) -> None:
        """See `Storage`."""
        self._database.execute('BEGIN IMMEDIATE')
        self._database.executemany('INSERT INTO events VALUES (?, ?, ?, ?, ?)', events)

    def commit(self) -> None:
        """See `Storage`."""
        self._database.execute('COMMIT')

    def rollback(self) -> None:
        """See `Storage`."""
        with contextlib.suppress(sqlite3.Error):
            self._database.execute('ROLLBACK')

    def note(self, head: bytes) -> None:
        """See `Storage`."""
        self._write_head(head)

    def close(self) -> None:
        """See `Storage`."""
        self._open.close()

    def _write_head(self, head: bytes) -> None:
        if os.pwrite(self._head, head, 0) < len(head):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def write_anew(folder: Path, events: Sequence[Event], head: bytes) -> None:
    """Write a database and a head in one piece, closed, so that there is no journal."""
    with contextlib.closing(sqlite3.connect(folder / DATABASE)) as database:
        database.execute(_TABLE)
        database.executemany('INSERT INTO events VALUES (?, ?, ?, ?, ?)', events)
        database.commit()
    (folder / HEAD).write_bytes(head)
