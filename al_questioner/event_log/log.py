"""An append-only log of events in SQLite that loses nothing it has confirmed, and knows what it has lost.

Each event carries a running number and a checksum that is chained over all before it, so that no event can be altered,
left out or moved unseen. `session.head` names the last event outside of the database, so that a lost end is seen too.
"""

from __future__ import annotations

import contextlib
import fcntl
import hashlib
import os
import shutil
import sqlite3
import tempfile
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from al_questioner.domain import EpisodeError, InputError
from al_questioner.event_log.storage import DATABASE, HEAD, Event, SqliteStorage, StorageFactory, write_anew
from al_questioner.support.files import make_folder, sync_to_disk
from al_questioner.support.text import one_line

LOCK = 'session.lock'
BROKEN = 'broken-'
"""Beginning of the names of files that a repair keeps as they were."""

_JOURNALS = ('-wal', '-shm')
_START = hashlib.sha256(b'al_questioner/session/1').digest()
"""Value that the first event's checksum is chained to."""


class SessionLogError(InputError):
    """A folder that holds no session log, or one that cannot be used; the text names it."""


class LogWriteError(EpisodeError):
    """An event that could not be brought to the disk."""


@dataclass(frozen=True)
class LogContents:
    """Readable content of a log: the events before the first damage, and what is wrong and where, if anything."""

    events: tuple[Event, ...]
    damage: str | None


class SessionLog:
    """A log that is written to, by one process at a time.

    What `append` has returned from survives whatever happens to the process or, as far as the disk keeps its word, to
    the machine. Once an event could not be written the log takes no more. Its folder is made if it is not there.

    Raises:
        SessionLogError: another process writes to it, it is damaged, or it cannot be written to.
    """

    def __init__(self, folder: Path, storage: StorageFactory = SqliteStorage) -> None:
        self.folder = folder
        self._failure = ''
        # A node may close it while its worker is about to write.
        self._in_use = threading.Lock()
        make_folder(folder)
        with contextlib.ExitStack() as stack:
            stack.enter_context(_unusable(folder))
            self._lock = stack.enter_context(_locked(folder))
            contents = _read(folder, live=False)
            if contents is not None and contents.damage:
                raise SessionLogError(
                    f'{folder}: {contents.damage}; `session {folder} --repair` keeps what is before the damage'
                )
            self.events: tuple[Event, ...] = () if contents is None else contents.events
            self._number = len(self.events)
            self._checksum = self.events[-1].checksum if self.events else _START
            self._storage = storage(folder, _head_of(self._number, self._checksum))
            stack.callback(self._storage.close)
            self._open = stack.pop_all()

    def append(self, *entries: tuple[str, bytes]) -> None:
        """Bring events, each a kind and a content, to the disk: all of them, or none.

        Raises:
            LogWriteError: they cannot be; neither can any event after them.
        """
        with self._in_use:
            if self._failure:
                raise LogWriteError(self._failure)
            number, checksum, events = self._number, self._checksum, []
            for kind, content in entries:
                number, stamp = number + 1, time.time_ns()
                checksum = _chained(checksum, number, kind, stamp, content)
                events.append(Event(number, kind, stamp, content, checksum))
            try:
                self._storage.write(events)
                self._storage.commit()
                self._number, self._checksum = number, checksum
                self._storage.note(_head_of(number, checksum))
            except (OSError, sqlite3.Error) as error:
                self._storage.rollback()
                reason = (isinstance(error, OSError) and error.strerror) or str(error)
                self._failure = (
                    f'{self.folder}: the session log cannot be written ({reason}): nothing is asked or taken any more;'
                    ' what was acknowledged is safe; free or repair the disk, and start the learner again'
                )
                raise LogWriteError(self._failure) from error

    def close(self) -> None:
        """Let another process write; nothing can be appended any more."""
        with self._in_use:
            self._failure = self._failure or f'{self.folder}: the session log is closed'
            self._open.close()

    def __enter__(self) -> SessionLog:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def read_log(folder: Path) -> LogContents:
    """Read a log; nothing in the folder is changed, and a learner may be writing to it.

    Raises:
        SessionLogError: there is no log in the folder, or it cannot be read.
    """
    if not folder.is_dir():
        raise SessionLogError(f'{folder}: {"not a folder" if folder.exists() else "does not exist"}')
    with _unusable(folder):
        try:
            with _locked(folder, make=False):
                contents = _read(folder, live=False)
        except _InUseError:
            contents = _read(folder, live=True)
    if contents is None:
        raise SessionLogError(f'{folder}: there is no session log in it')
    return contents


def repair_log(folder: Path) -> LogContents:
    """Rewrite a damaged log from what comes before the damage, and keep the damaged files as `broken-*`.

    A repair that is interrupted can be repeated.

    Returns:
        What the log held.

    Raises:
        SessionLogError: there is no log, nothing of it can be read, a learner is writing to it, a damaged one was kept
            before, or it cannot be written to.
    """
    with _unusable(folder), _locked(folder):
        contents = _read(folder, live=False)
        if contents is None:
            raise SessionLogError(f'{folder}: there is no session log in it')
        if contents.damage is None:
            return contents
        if not contents.events:
            raise SessionLogError(f'{folder}: {contents.damage}; nothing can be recovered')
        database = folder / DATABASE
        kept = folder / f'{BROKEN}{DATABASE}'
        if database.exists() and kept.exists():
            raise SessionLogError(f'{kept}: exists already; move it away to repair once more')
        with tempfile.TemporaryDirectory(dir=folder, prefix='.repairing-') as made:
            last = contents.events[-1]
            write_anew(Path(made), contents.events, _head_of(last.number, last.checksum))
            # The database first: as long as there is none, the repair is seen to be unfinished.
            for name in (DATABASE, *(DATABASE + suffix for suffix in _JOURNALS), HEAD):
                if (folder / name).exists() and not (folder / f'{BROKEN}{name}').exists():
                    (folder / name).rename(folder / f'{BROKEN}{name}')
            sync_to_disk(folder)
            for name in (HEAD, DATABASE):
                sync_to_disk(Path(made) / name)
                (Path(made) / name).replace(folder / name)
        sync_to_disk(folder)
    return contents


def _read(folder: Path, live: bool) -> LogContents | None:
    """Read the log of a folder; return None if there is none.

    Unless it is live, written to meanwhile, a copy is read: opening a database changes its files.
    """
    names = [DATABASE, DATABASE + _JOURNALS[0], HEAD]
    unfinished = not (folder / DATABASE).exists() and (folder / f'{BROKEN}{DATABASE}').exists()
    if not unfinished and not any((folder / name).exists() for name in names[:2]) and _is_unused(folder / HEAD):
        return None
    if live:
        head = _read_head(folder / HEAD)
        return _judged(*_read_events(f'{(folder / DATABASE).absolute().as_uri()}?mode=ro'), head)
    with tempfile.TemporaryDirectory() as copied:
        for name in names:
            # An interrupted repair may have moved some of the files away and not yet the others.
            kept, source = folder / f'{BROKEN}{name}', folder / name
            with contextlib.suppress(FileNotFoundError):
                shutil.copyfile(kept if unfinished and kept.exists() else source, Path(copied) / name)
        head = _read_head(Path(copied) / HEAD)
        contents = _judged(*_read_events((Path(copied) / DATABASE).absolute().as_uri()), head)
    if unfinished and contents.damage is None:
        return LogContents(contents.events, 'a repair was interrupted')
    return contents


def _is_unused(head: Path) -> bool:
    """Return whether no event was ever noted: a session that began on a full disk, or was killed at once."""
    return not head.exists() or _head_of(0, _START).startswith(head.read_bytes())


def _read_events(uri: str) -> tuple[list[Event], str | None]:
    """Read the events of a database up to the first that is damaged, and say what is wrong with that one."""
    events: list[Event] = []
    checksum = _START
    try:
        with contextlib.closing(sqlite3.connect(uri, uri=True)) as database:
            if not database.execute("SELECT count(*) FROM sqlite_master WHERE name = 'events'").fetchone()[0]:
                return events, None
            for row in database.execute('SELECT number, kind, stamp, content, checksum FROM events ORDER BY number'):
                number = len(events) + 1
                if row[0] != number:
                    return events, f'event {number} is missing'
                if tuple(map(type, row)) != (int, str, int, bytes, bytes) or row[4] != _chained(checksum, *row[:4]):
                    return events, f'event {number} is damaged (its checksum is wrong)'
                events.append(Event(*row))
                checksum = row[4]
    except (sqlite3.Error, UnicodeError) as error:
        return events, f'event {len(events) + 1} cannot be read ({one_line(error)})'
    return events, None


def _head_of(number: int, checksum: bytes) -> bytes:
    return f'{number:020d} {checksum.hex()}\n'.encode()


def _read_head(path: Path) -> tuple[int, bytes] | str:
    """Number and checksum of the last event that was noted, or why they are not known."""
    try:
        number, checksum = path.read_bytes().split()
        return int(number), bytes.fromhex(checksum.decode())
    except FileNotFoundError:
        return f'{HEAD} is missing: whether the last events are lost cannot be told'
    except ValueError:
        return f'{HEAD} is damaged: whether the last events are lost cannot be told'


def _judged(events: Sequence[Event], damage: str | None, head: tuple[int, bytes] | str) -> LogContents:
    """Return the events with what is wrong: the head shows damage that the database cannot show."""
    if isinstance(head, str):
        return LogContents(tuple(events), damage or head)
    number, checksum = head
    if number > len(events):
        lost = f'of {number} events only the first {len(events)} are left'
        return LogContents(tuple(events), f'{damage}; {lost}' if damage else lost)
    noted = events[number - 1].checksum if number else _START
    if damage is None and noted != checksum:
        damage = f'{HEAD} is not that of these events'
    return LogContents(tuple(events), damage)


def _chained(previous: bytes, number: int, kind: str, stamp: int, content: bytes) -> bytes:
    """Return the checksum of an event."""
    description = f'{number} {kind} {stamp} {len(content)}\n'.encode()
    return hashlib.sha256(previous + description + content).digest()


class _InUseError(SessionLogError):
    """Another process writes to the log."""


@contextlib.contextmanager
def _locked(folder: Path, make: bool = True) -> Iterator[None]:
    """Hold the lock of a log, which ends with the process however that ends.

    Readers share the lock and make no file for it: where none is, nobody writes.
    """
    path = folder / LOCK
    if not make and not path.exists():
        yield
        return
    descriptor = os.open(path, (os.O_RDWR | os.O_CREAT) if make else os.O_RDONLY, 0o644)
    try:
        try:
            fcntl.flock(descriptor, (fcntl.LOCK_EX if make else fcntl.LOCK_SH) | fcntl.LOCK_NB)
        except BlockingIOError:
            raise _InUseError(f'{folder}: another process is using this session') from None
        yield
    finally:
        os.close(descriptor)


@contextlib.contextmanager
def _unusable(folder: Path) -> Iterator[None]:
    """Make every error of the disk one that names the folder."""
    try:
        yield
    except OSError as error:
        raise SessionLogError(f'{folder}: the session log cannot be used ({error.strerror})') from error
    except sqlite3.Error as error:
        raise SessionLogError(f'{folder}: the session log cannot be used ({one_line(error)})') from error
