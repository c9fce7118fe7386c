"""Small bags of texts, and what stands in the bag that ships."""

from __future__ import annotations

import contextlib
import sqlite3
import time
from pathlib import Path

from al_questioner.bags import BagMessage, BagWriter, Topic, read_bag
from al_questioner.bags.reading import typestore
from al_questioner.bags.storages import storage_files
from shared.checkout import ROOT

SHIPPED = ROOT / 'bags' / 'expert_0'
STRING = 'std_msgs/msg/String'
TOPICS = [Topic('/x/turn', STRING, True), Topic('/x/answer', STRING, False)]


def text(content: str) -> bytes:
    return bytes(typestore().serialize_cdr(typestore().types[STRING](content), STRING))


def write(path: Path, count: int = 10, storage: str = 'mcap', first: int = 1000) -> Path:
    """A bag of `count` numbers on one topic, from a stamp on, and of none on the other."""
    with BagWriter(path, TOPICS, storage) as bag:
        for number in range(count):
            bag.write('/x/turn', text(str(number)), first + number)
    return path


def make_old(database: Path) -> None:
    """Take from a bag's database what its first versions did not have."""
    with contextlib.closing(sqlite3.connect(database)) as connection:
        for column in ('offered_qos_profiles', 'type_description_hash'):
            connection.execute(f'ALTER TABLE topics DROP COLUMN {column}')
        for table in ('schema', 'metadata', 'message_definitions'):
            connection.execute(f'DROP TABLE {table}')
        connection.commit()


def recorded(name: str) -> list[BagMessage]:
    """The messages of a topic in the bag that ships."""
    return [message for message in read_bag(SHIPPED).messages if message.topic.endswith(f'/{name}')]


def wait_for_content(bag: Path, content: bytes, seconds: float = 90.0) -> None:
    """Wait until a bag's file of messages has this on the disk, and no journal from which it would be rolled back."""
    end = time.monotonic() + seconds
    while not any(content in file.read_bytes() for file in storage_files(bag)) or any(bag.glob('*-journal')):
        assert time.monotonic() < end, f'{bag} never held {content!r}'
        time.sleep(0.05)
