"""Writing of rosbag2 bags that remain readable if the writing process is killed."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import re
import shutil
import sqlite3
import struct
import zlib
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from importlib.metadata import distributions
from io import BytesIO
from pathlib import Path

from rosbags.interfaces import Connection, Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import Channel, McapWriter, write_channel, write_string
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from al_questioner.bags.reading import BagError, Topic, typestore
from al_questioner.bags.settings import STORAGE
from al_questioner.bags.storages import storage_files
from al_questioner.support.files import sync_to_disk

FIRST = '_0'
"""Suffix added to the name of a bag for its first file; `ros2 bag reindex` expects a number."""
_FOREVER = QosTime(9223372036, 854775807)
_CRC_OFFSET = 33
"""Number of bytes from the beginning of an MCAP chunk record to its checksum.

These are the opcode, the length, two times and the uncompressed size.
"""


class _DurableMcap(McapWriter):
    """MCAP writer of rosbags that can end a chunk on request; otherwise messages stay in memory until it has 1 MiB.

    It also writes the chunk's checksum, without which a flipped bit would not be noticed, and the hash of each
    topic's type.
    """

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        super().__init__(path, compression)
        self.path = _named_as_first(self.path)

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        metadata = BytesIO()
        for text in ('offered_qos_profiles', offered_qos_profiles, 'topic_type_hash', connection.digest):
            write_string(metadata, text)
        channel = Channel(connection.id, connection.msgtype, connection.topic, 'cdr', metadata.getvalue())
        self.channels.append(channel)
        self.channel_stats[connection.id] = 0
        write_channel(self.chunk.bio, channel, self.schemas)

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

    def close(self, version: int, metadata: str) -> None:
        super().close(version, _with_distribution(metadata))


class _DurableSqlite3(Sqlite3Writer):
    """SQLite writer of rosbags that can commit on request; otherwise the whole recording is one transaction.

    It may be used by another thread than the one that made it, but only by one at a time.
    """

    def __init__(self, path: Path, compression: CompressionMode) -> None:
        super().__init__(path, compression)
        self.conn.close()
        self.path = _named_as_first(self.path)
        self.conn = sqlite3.connect(self.path, check_same_thread=False)
        self.cursor = self.conn.cursor()
        self.cursor.execute('UPDATE schema SET ros_distro = ?', (ros_distribution(),))

    def sync(self) -> None:
        self.conn.commit()

    def close(self, version: int, metadata: str) -> None:
        super().close(version, _with_distribution(metadata))


class _Writer(Writer):
    STORAGE_PLUGINS = {StoragePlugin.MCAP: _DurableMcap, StoragePlugin.SQLITE3: _DurableSqlite3}  # noqa: RUF012

    def close(self) -> None:
        super().close()
        finished = self.metapath.with_suffix('.yaml.finished')
        finished.write_text(_with_distribution(self.metapath.read_text('utf-8')), 'utf-8')
        finished.replace(self.metapath)


class BagWriter:
    """Writer of a new bag, in the format that ROS 2 Jazzy writes.

    Messages before the last `sync` survive a crash of the process and, if the disk stores what it confirms, of the
    machine; `repair` completes a bag that was never closed. After an error of writing, the bag accepts no more
    messages. It is then left for `repair`, or removed if no message had reached the disk. Use it as a context manager,
    by one thread at a time. Its directory must not exist.

    Raises:
        BagError: something is at the path already, it cannot be written to, or a type that Jazzy does not have.
    """

    def __init__(self, path: Path, topics: Sequence[Topic], storage: str = STORAGE.default) -> None:
        if storage not in STORAGE.choices:
            raise BagError(f'unknown storage {storage!r}; known: {", ".join(STORAGE.choices)}')
        if path.exists():
            raise BagError(f'{path}: exists already; a bag is never overwritten')
        unknown = sorted({topic.type for topic in topics} - typestore().fielddefs.keys())
        if unknown:
            raise BagError(f'{path}: no message type {", ".join(unknown)} in ROS 2 Jazzy')
        self.path = path
        self._counts = Counter[str]({topic.name: 0 for topic in topics})
        self._holds_messages = False
        self._writer = _Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
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
        """Write a message (CDR) received at a time, nanoseconds since the epoch; it is durable after the next `sync`.

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
        """Flush all written messages to the disk.

        Raises:
            OSError: it cannot be written.
        """
        with self._disk():
            self._storage().sync()
        self._holds_messages = any(self._counts.values())

    def close(self) -> None:
        """Write the index and `metadata.yaml`; a bag with an earlier error of writing is left as it is.

        Raises:
            OSError: it cannot be written.
        """
        if not self._writer.storage:
            return
        # Messages first: without an index the bag can still be repaired.
        self.sync()
        if not any(self._counts.values()):
            # rosbags would write the largest integer as the start of an empty bag.
            self._writer.min_timestamp = 0
        with self._disk():
            self._writer.close()
            for path in (*storage_files(self.path), self.path / 'metadata.yaml', self.path):
                sync_to_disk(path)

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _connect(self, topic: Topic) -> Connection:
        return self._writer.add_connection(
            topic.name, topic.type, typestore=typestore(), offered_qos_profiles=[_qos(topic.latched)]
        )

    @contextlib.contextmanager
    def _disk(self) -> Iterator[None]:
        """Convert every error of the disk to an OSError, and allow no more writing after it."""
        try:
            yield
        except (OSError, sqlite3.Error) as error:
            # This tries to write the buffer once more, and fails once more.
            with contextlib.suppress(OSError, sqlite3.Error):
                self._writer.abort()
            if not self._holds_messages:
                # There is nothing to repair, and a new attempt needs the path.
                shutil.rmtree(self.path, ignore_errors=True)
            if isinstance(error, sqlite3.Error):
                raise OSError(errno.EIO, str(error), str(self.path)) from error
            raise

    def _storage(self) -> _DurableMcap | _DurableSqlite3:
        storage = self._writer.storage
        if not isinstance(storage, (_DurableMcap, _DurableSqlite3)):
            raise OSError(f'{self.path} is closed')
        return storage


@cache
def ros_distribution() -> str:
    """Return the name of the ROS distribution, such as 'jazzy', or an empty text if it is not known.

    It comes from the environment or from the installed rclpy. `ros2 bag` also writes an empty text for an unknown one.
    """
    named = os.environ.get('ROS_DISTRO', '')
    if named:
        return named
    wheels = (re.fullmatch(r'ros-(\w+)-rclpy', distribution.name or '') for distribution in distributions())
    return next((wheel[1] for wheel in wheels if wheel), '')


def _with_distribution(metadata: str) -> str:
    """Return the metadata of rosbags with the name of the ROS distribution, for which rosbags writes its own name."""
    return re.sub(r'(?m)^( *ros_distro: )rosbags$', lambda line: line[1] + json.dumps(ros_distribution()), metadata)


def _named_as_first(path: Path) -> Path:
    """Rename a bag's file, which may be open, as `ros2 bag record` names it."""
    return path.rename(path.with_name(f'{path.stem}{FIRST}{path.suffix}'))


def _qos(latched: bool) -> Qos:
    """Return the profiles of `ros/qos.py` as rosbags expects them."""
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
