"""Writing rosbag2 bags that survive the end of the writing process."""

from __future__ import annotations

import contextlib
import errno
import os
import sqlite3
import struct
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType

from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from al_questioner.files import sync_to_disk
from al_questioner.recording.bags import BagError, Topic, typestore
from al_questioner.recording.storages import STORAGE_SUFFIXES, storage_files

_STORAGES = {'mcap': StoragePlugin.MCAP, 'sqlite3': StoragePlugin.SQLITE3}
_FOREVER = QosTime(9223372036, 854775807)
_CRC_OFFSET = 33
"""Bytes from the beginning of an MCAP chunk record to its checksum: opcode, length, two times, uncompressed size."""


class _DurableMcap(McapWriter):
    """rosbags' writer keeps messages in memory until a chunk of 1 MiB is full; this one can be told to end a chunk.

    It also writes the chunk's checksum, without which a flipped bit would be another message.
    """

    def close_chunk(self) -> None:
        checksum, start = zlib.crc32(self.chunk.bio.getvalue()), self.bio.tell()
        super().close_chunk()
        self.bio.seek(start + _CRC_OFFSET)
        self.bio.write(struct.pack('<I', checksum))
        self.bio.seek(0, os.SEEK_END)

    def sync(self) -> None:
        if self.chunk.msgs:
            self.close_chunk()
        self.bio.flush()
        os.fsync(self.bio.fileno())


class _DurableSqlite3(Sqlite3Writer):
    """rosbags' writer makes one transaction of the whole recording; this one can be told to commit.

    It may be used by another thread than the one that made it, as long as there is only one at a time.
    """

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        super().__init__(path, compression)
        self.conn.close()
        self.conn = sqlite3.connect(self.path, check_same_thread=False)
        self.cursor = self.conn.cursor()

    def sync(self) -> None:
        self.conn.commit()


class _Writer(Writer):
    STORAGE_PLUGINS = {StoragePlugin.MCAP: _DurableMcap, StoragePlugin.SQLITE3: _DurableSqlite3}  # noqa: RUF012


class BagWriter:
    """A new bag, of the format that ROS 2 Jazzy writes.

    What was written before the last `sync` survives whatever happens to the process or, as far as the disk keeps its
    word, to the machine; `repair` makes a bag whole that was never closed. Once something could not be written the bag
    takes no more and is left for `repair`. Use it as a context manager, by one thread at a time.

    Args:
        path: directory of the bag, which must not exist.
        topics: what can be written.
        storage: 'mcap' or 'sqlite3'.

    Raises:
        BagError: something is at the path already, it cannot be written to, or a type that Jazzy does not have.
    """

    def __init__(self, path: Path, topics: Sequence[Topic], storage: str = 'mcap') -> None:
        if storage not in _STORAGES:
            raise BagError(f'unknown storage {storage!r}; known: {", ".join(STORAGE_SUFFIXES)}')
        if path.exists():
            raise BagError(f'{path}: exists already; a bag is never overwritten')
        unknown = sorted({topic.type for topic in topics} - typestore().fielddefs.keys())
        if unknown:
            raise BagError(f'{path}: no message type {", ".join(unknown)} in ROS 2 Jazzy')
        self.path = path
        self._counts = Counter[str]({topic.name: 0 for topic in topics})
        self._writer = _Writer(path, version=9, storage_plugin=_STORAGES[storage])
        try:
            with self._disk():
                self._writer.open()
                self._connections = {topic.name: self._connect(topic) for topic in topics}
            self.sync()
        except OSError as error:
            raise BagError(f'{path}: cannot be written ({error.strerror})') from error

    @property
    def counts(self) -> Mapping[str, int]:
        """Number of messages written, by topic."""
        return self._counts

    def write(self, topic: str, data: bytes, stamp: int) -> None:
        """Write a message; it is safe after the next `sync`.

        Args:
            topic: name of one of the bag's topics.
            data: serialised message, CDR.
            stamp: when it was received, nanoseconds since the epoch.

        Raises:
            KeyError: not one of the topics.
            OSError: it cannot be written.
        """
        connection = self._connections[topic]
        with self._disk():
            self._storage()
            self._writer.write(connection, stamp, data)
        self._counts[topic] += 1

    def sync(self) -> None:
        """Bring what was written to the disk.

        Raises:
            OSError: it cannot be written.
        """
        with self._disk():
            self._storage().sync()

    def close(self) -> None:
        """Finish the bag: its index, and `metadata.yaml`; one that could not be written to is left as it is.

        Raises:
            OSError: it cannot be written.
        """
        if not self._writer.storage:
            return
        if not any(self._counts.values()):
            # rosbags would write the largest integer for the start of nothing.
            self._writer.min_timestamp = 0
        with self._disk():
            self._writer.close()
            for path in (*storage_files(self.path), self.path / 'metadata.yaml', self.path):
                sync_to_disk(path)

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _connect(self, topic: Topic) -> Connection:
        return self._writer.add_connection(
            topic.name, topic.type, typestore=typestore(), offered_qos_profiles=[_qos(topic.latched)]
        )

    @contextlib.contextmanager
    def _disk(self) -> Iterator[None]:
        """Make every error of the disk an OSError, after which nothing may follow what was half written."""
        try:
            yield
        except (OSError, sqlite3.Error) as error:
            # What was buffered is tried once more, and fails once more.
            with contextlib.suppress(OSError, sqlite3.Error):
                self._writer.abort()
            if isinstance(error, sqlite3.Error):
                raise OSError(errno.EIO, str(error), str(self.path)) from error
            raise

    def _storage(self) -> _DurableMcap | _DurableSqlite3:
        storage = self._writer.storage
        if not isinstance(storage, (_DurableMcap, _DurableSqlite3)):
            raise OSError(f'{self.path} is closed')
        return storage


def _qos(latched: bool) -> Qos:
    """The profiles of `ros/qos.py`, in the words of rosbags."""
    return Qos(
        history=QosHistory.KEEP_LAST,
        depth=1 if latched else 10,
        reliability=QosReliability.RELIABLE,
        durability=QosDurability.TRANSIENT_LOCAL if latched else QosDurability.VOLATILE,
        deadline=_FOREVER,
        lifespan=_FOREVER,
        liveliness=QosLiveliness.AUTOMATIC,
        liveliness_lease_duration=_FOREVER,
        avoid_ros_namespace_conventions=False,
    )
