"""Reading of complete rosbag2 bags, whose message counts are right, without ROS."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

from rosbags.interfaces import Connection, ConnectionExtRosbag2, QosDurability
from rosbags.rosbag2 import Reader
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from al_questioner.bags.settings import STORAGE_SUFFIXES
from al_questioner.bags.storages import (
    BROKEN,
    files_of,
    holds_messages,
    is_compressed,
    of_ros_1,
    storage_files,
    written_order,
)
from al_questioner.domain import InputError
from al_questioner.support.text import one_line


class BagError(InputError):
    """A bag that cannot be read or written; the text says which and why."""


@dataclass(frozen=True)
class Topic:
    """A topic of a bag: its full name as recorded, the type of its messages, such as 'std_msgs/msg/String'.

    It is latched if its publisher was transient local.
    """

    name: str
    type: str
    latched: bool


@dataclass(frozen=True)
class BagMessage:
    """A message of a bag, serialised (CDR), with the time of its receipt in nanoseconds since the epoch."""

    topic: str
    type: str
    stamp: int
    data: bytes


@dataclass(frozen=True)
class Bag:
    """Content of a bag, all messages in the order of their receipt; stamps may go back if the recorder's clock did."""

    path: Path
    topics: tuple[Topic, ...]
    messages: tuple[BagMessage, ...]


def read_bag(path: Path) -> Bag:
    """Read a bag of any storage and compression that rosbags supports.

    The files and the metadata may differ, for example in the quality of service of a topic. Only the names and the
    numbers of messages have to agree.

    Raises:
        BagError: there is no bag, it is of ROS 1, broken or empty, or messages are missing that its metadata count.
    """
    _check_there(path)
    try:
        with Reader(path) as reader:
            files = files_of(reader)
            topics = _topics([*reader.connections, *(c for file in files for c in file.connections)])
            expected = Counter[str]()
            for connection in reader.connections:
                expected[connection.topic] += connection.msgcount
            messages = [
                BagMessage(connection.topic, connection.msgtype, stamp, data)
                for file in files
                for connection, stamp, data in written_order(file)
            ]
    except Exception as error:
        raise BagError(f'{path}: cannot be read ({one_line(error) or type(error).__name__}){_hint(path)}') from error
    found = Counter(message.topic for message in messages)
    short = [f'{found[name]} of {count} on {name}' for name, count in expected.items() if found[name] < count]
    if short:
        raise BagError(f'{path}: messages are missing: {", ".join(short)}')
    if not messages:
        raise BagError(f'{path}: the bag is empty')
    return Bag(path, topics, tuple(_in_order_of_receipt(messages)))


def _topics(connections: Sequence[Connection]) -> tuple[Topic, ...]:
    """Return each topic once, with each of its types; it is latched if any connection is."""
    latched: dict[tuple[str, str], bool] = {}
    for connection in connections:
        key = (connection.topic, connection.msgtype)
        latched[key] = latched.get(key, False) or _is_latched(connection.ext)
    return tuple(Topic(name, type_, is_latched) for (name, type_), is_latched in latched.items())


def _in_order_of_receipt(messages: Sequence[BagMessage]) -> list[BagMessage]:
    """Return messages, given in the order of writing, in the order of their receipt.

    A file may hold one topic after the other, so the messages are sorted by stamp. But if the stamps go back within a
    topic, the recorder's clock was set back, and the order of writing is kept.
    """
    last: dict[str, int] = {}
    for message in messages:
        if message.stamp < last.get(message.topic, message.stamp):
            return list(messages)
        last[message.topic] = message.stamp
    return sorted(messages, key=lambda message: message.stamp)


def deserialize(message: BagMessage) -> Any:
    """Return the message as an object of rosbags, whose members are those of ROS.

    Raises:
        BagError: a type that ROS 2 Jazzy does not have, or bytes that do not fit it.
    """
    try:
        return typestore().deserialize_cdr(message.data, message.type)
    except Exception as error:
        raise BagError(f'{message.topic}: not a {message.type} ({one_line(error) or type(error).__name__})') from error


def digest(path: Path) -> str:
    """Return the SHA-256 of all files of a bag that hold messages, in order, as hexadecimal digits.

    Raises:
        BagError: there is no such file.
    """
    total = hashlib.sha256()
    files = [path] if path.is_file() else sorted(file for file in path.iterdir() if holds_messages(file))
    if not files:
        raise BagError(f'{path}: holds no file with messages')
    for file in files:
        total.update(file.read_bytes())
    return total.hexdigest()


@lru_cache(maxsize=1)
def typestore() -> Typestore:
    """Return the message types of ROS 2 Jazzy."""
    return get_typestore(Stores.ROS2_JAZZY)


def _check_there(path: Path) -> None:
    if not path.exists():
        raise BagError(f'{path}: there is no such bag')
    for file in [path, *(filter(holds_messages, path.iterdir()) if path.is_dir() else [])]:
        # Opening a pipe would wait for a writer.
        if file.exists() and not (file.is_file() or file.is_dir()):
            raise BagError(f'{file}: is no bag, but a device or a pipe')
    is_bag = path.is_dir() and (path / 'metadata.yaml').is_file()
    try:
        old = of_ros_1(path)
    except OSError as error:
        raise BagError(f'{path}: cannot be read ({error.strerror})') from error
    if old is not None:
        advice = f'; convert it: rosbags-convert --src {old} --dst NEW_BAG' if old.suffix == '.bag' else ''
        raise BagError(f'{old}: is a bag of ROS 1, not of ROS 2{advice}')
    if not is_bag and is_compressed(path):
        raise BagError(f'{path}: is compressed; decompress its file (unzstd) and then: record --repair {path}')
    if path.is_dir() and not is_bag:
        if any(storage_files(path)):
            raise BagError(
                f'{path}: metadata.yaml is missing, as after a recording that was killed: record --repair {path}'
            )
        raise BagError(f'{path}: is no bag (no metadata.yaml and no file with messages in it)')
    if path.is_file() and path.suffix not in STORAGE_SUFFIXES.values():
        raise BagError(f'{path}: is no bag (a directory with metadata.yaml, or a .mcap or .db3 file)')


def _hint(path: Path) -> str:
    """Return advice on a broken bag, or an empty text if it has no uncompressed file that could be repaired."""
    # An interrupted repair may have left only the originals.
    usable = path.is_dir() and (any(storage_files(path)) or any(path.glob(f'*{BROKEN}')))
    return f'; try record --repair {path}' if usable else ''


def _is_latched(extension: object) -> bool:
    if not isinstance(extension, ConnectionExtRosbag2):
        return False
    return any(profile.durability is QosDurability.TRANSIENT_LOCAL for profile in extension.offered_qos_profiles)
