"""Files of bags: which ones hold messages, and their content in the order of writing."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from rosbags.interfaces import Connection
from rosbags.rosbag2 import Reader
from rosbags.rosbag2.reader import DirectoryReader
from rosbags.rosbag2.storage_mcap import McapReader
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Reader

from al_questioner.bags.settings import STORAGE_SUFFIXES

if TYPE_CHECKING:
    from rosbags.rosbag2.reader import ReaderProtocol

COMPRESSED = '.zstd'
"""Suffix added to the name of a file that was compressed as a whole."""

BROKEN = '.broken'
"""Suffix added to the name of a broken file that a repair keeps."""

_ZSTD = b'\x28\xb5\x2f\xfd'
"""First bytes of data that zstd has compressed; a serialised message begins with 0."""
_ROS_1 = b'#ROSBAG V'
_MCAP_OF_ROS_1 = b'\x04\x00\x00\x00ros1'
"""Profile of ROS 1 in the first record of an MCAP file."""


def storage_files(path: Path) -> Iterator[Path]:
    """Yield the files of a bag's directory that hold messages and are not compressed."""
    for suffix in STORAGE_SUFFIXES.values():
        yield from sorted(filter(Path.is_file, path.glob(f'*{suffix}')), key=lambda file: place_of(file.name))


def place_of(name: str) -> tuple[int, str]:
    """Return the sort key of a file among those of a bag, which are numbered without leading zeros."""
    number = re.search(r'_(\d+)\.(mcap|db3)', name)
    return (int(number[1]) if number else -1, name)


def holds_messages(file: Path) -> bool:
    """Return whether a file is a storage file of a bag, compressed or not."""
    return file.suffix != BROKEN and bool({*file.suffixes} & {*STORAGE_SUFFIXES.values()})


def is_compressed(path: Path) -> bool:
    """Return whether a path is a compressed storage file, or a directory with one."""
    files = path.iterdir() if path.is_dir() else [path]
    return any(holds_messages(file) and file.suffix == COMPRESSED for file in files)


def of_ros_1(path: Path) -> Path | None:
    """Return the file that ROS 1 recorded: the path itself, or one of a bag's directory; None if there is none."""
    files = (
        [path] if path.is_file() else list(storage_files(path)) or [*filter(Path.is_file, sorted(path.glob('*.bag')))]
    )
    for file in files:
        with file.open('rb') as stream:
            head = stream.read(64)
        if head.startswith(_ROS_1) or (head.startswith(b'\x89MCAP') and _MCAP_OF_ROS_1 in head):
            return file
    return None


def files_of(reader: Reader) -> list[ReaderProtocol]:
    """Return the readers of the single files of an open bag, in order."""
    return reader.storage.storages if isinstance(reader.storage, DirectoryReader) else [reader.storage]


def written_order(storage: ReaderProtocol) -> Iterator[tuple[Connection, int, bytes]]:
    """Yield the messages of a file, with their topics and stamps, in the order of writing.

    The stamps come from the recorder's clock. If it was set back, they are in another order.
    """
    if isinstance(storage, McapReader):
        found: Iterator[tuple[Connection, int, bytes]] = storage.messages_scan(storage.connections)
    elif isinstance(storage, Sqlite3Reader):
        found = _rows(storage)
    else:
        raise TypeError(f'unknown storage {type(storage).__name__}')
    for connection, stamp, data in found:
        yield connection, stamp, plain(bytes(data))


def plain(data: bytes) -> bytes:
    """Return the bytes of a message, decompressed if necessary."""
    if not data.startswith(_ZSTD):
        return data
    # Use the library of the writer: its name depends on the version of Python.
    from rosbags.rosbag2 import reader

    return bytes(reader.zstd.decompress(data))  # type: ignore[attr-defined]


def _rows(storage: Sqlite3Reader) -> Iterator[tuple[Connection, int, bytes]]:
    by_number = {connection.id: connection for connection in storage.connections}
    if storage.dbconn is not None:
        rows = storage.dbconn.execute('SELECT topic_id, timestamp, data FROM messages ORDER BY rowid')
        for number, stamp, data in rows:
            if number in by_number:
                yield by_number[number], stamp, data
