"""Making a bag whole whose recording was killed."""

from __future__ import annotations

import contextlib
import re
import sqlite3
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from al_questioner.bags.reading import BagError, BagMessage, Topic, read_bag, typestore
from al_questioner.bags.storages import plain, storage_files
from al_questioner.bags.writing import FIRST, BagWriter
from al_questioner.support.files import sync_to_disk

_BROKEN = '.broken'
"""Added to the name of the file that is kept as it was."""


@dataclass(frozen=True)
class RepairReport:
    """What came of a repair.

    Attributes:
        was_whole: nothing had to be done.
        kept: number of messages, by topic.
        original: the broken file, which was kept under another name; None if the bag was whole.
    """

    was_whole: bool
    kept: Mapping[str, int]
    original: Path | None = None


def repair(path: Path) -> RepairReport:
    """Rewrite a bag from every message that reached the disk; a whole bag is left alone.

    A repair that is itself interrupted can be repeated.

    Args:
        path: directory of the bag.

    Raises:
        BagError: no bag, nothing readable in it, or its directory cannot be written to.
    """
    try:
        whole = read_bag(path)
    except BagError as error:
        # A kept original alone is what an interrupted repair leaves.
        kept = sorted(path.glob(f'*{_BROKEN}')) if path.is_dir() else []
        files = (list(storage_files(path)) if path.is_dir() else []) or kept
        if not files:
            raise
        if len(files) > 1:
            raise BagError(f'{path}: a bag of {len(files)} files cannot be repaired') from error
        return _rewrite(path, files[0])
    return RepairReport(True, Counter(message.topic for message in whole.messages))


def _rewrite(path: Path, broken: Path) -> RepairReport:
    name = broken.name.removesuffix(_BROKEN)
    kept_as = broken.with_name(name + _BROKEN)
    if broken != kept_as and kept_as.exists():
        raise BagError(f'{kept_as}: exists already; move it away to repair once more')
    is_mcap = name.endswith('.mcap')
    try:
        topics, messages = _salvage_mcap(broken) if is_mcap else _salvage_sqlite3(broken)
        if not messages:
            raise BagError(f'{path}: no message can be read from {broken.name}')
        with tempfile.TemporaryDirectory(dir=path, prefix='.repairing-') as folder:
            rewritten = Path(folder) / Path(name).stem.removesuffix(FIRST)
            with BagWriter(rewritten, topics, 'mcap' if is_mcap else 'sqlite3') as writer:
                for message in messages:
                    writer.write(message.topic, message.data, message.stamp)
            broken.rename(kept_as)
            # The messages last: as long as they are not there, the bag is seen to be broken.
            for file in (rewritten / 'metadata.yaml', *storage_files(rewritten)):
                file.replace(path / file.name)
        sync_to_disk(path)
    except OSError as error:
        raise BagError(f'{path}: cannot be repaired ({error.strerror})') from error
    return RepairReport(False, Counter(message.topic for message in messages), kept_as)


def _salvage_mcap(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    """Topics and messages of a file, as far as it can be read."""
    schemas: dict[int, Schema] = {}
    topics: dict[int, Topic] = {}
    found: list[Message] = []
    for record in _complete_records(file):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel) and record.schema_id in schemas:
            topics[record.id] = Topic(
                record.topic,
                schemas[record.schema_id].name,
                _is_latched(record.metadata.get('offered_qos_profiles', '')),
            )
        elif isinstance(record, Message):
            found.append(record)
    # Only now, as the end of a file repeats the channels that a broken chunk may have lost.
    messages = [
        BagMessage(topics[message.channel_id].name, topics[message.channel_id].type, message.log_time, message.data)
        for message in found
        if message.channel_id in topics
    ]
    return _consistent(topics.values(), messages)


def _is_latched(offered_qos_profiles: str) -> bool:
    """Whether a profile is transient local, in the words of today or the numbers of earlier versions."""
    return re.search(r'durability: (transient_local|1)\b', offered_qos_profiles) is not None


def _complete_records(file: Path) -> Iterator[object]:
    """The records up to the first that is not complete, without the chunks whose checksum is wrong."""
    with file.open('rb') as stream:
        try:
            for record in StreamReader(stream, emit_chunks=True).records:
                yield from _records_of_chunk(record) if isinstance(record, Chunk) else [record]
        except OSError:
            raise
        except Exception:  # noqa: BLE001 - a record that was cut off fails in as many ways as it has fields
            return


def _records_of_chunk(chunk: Chunk) -> list[object]:
    try:
        return list(breakup_chunk(chunk, validate_crc=True))
    except Exception:  # noqa: BLE001 - so does a chunk that was overwritten
        return []


def _salvage_sqlite3(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    """Topics and messages of a file, as far as it can be read."""
    topics: dict[int, Topic] = {}
    messages: list[BagMessage] = []
    try:
        # Closed at once: its journal must not be taken for that of the new file.
        with contextlib.closing(sqlite3.connect(file)) as database:
            # The first versions of rosbag2 had no such column.
            columns = [row[1] for row in database.execute('PRAGMA table_info(topics)')]
            profiles = 'offered_qos_profiles' if 'offered_qos_profiles' in columns else "''"
            for number, name, type_, qos in database.execute(f'SELECT id, name, type, {profiles} FROM topics'):
                if all(isinstance(column, str) for column in (name, type_, qos)):
                    topics[number] = Topic(name, type_, _is_latched(qos))
            for number, stamp, data in database.execute(
                'SELECT topic_id, timestamp, data FROM messages ORDER BY rowid'
            ):
                if number in topics and isinstance(stamp, int) and isinstance(data, bytes):
                    messages.append(BagMessage(topics[number].name, topics[number].type, stamp, data))
    except sqlite3.Error:
        # What was read before the broken page is kept.
        pass
    return _consistent(topics.values(), messages)


def _consistent(topics: Iterable[Topic], messages: Iterable[BagMessage]) -> tuple[list[Topic], list[BagMessage]]:
    """One topic of each name, of a type that can be written, and its messages."""
    known = typestore().fielddefs
    by_name: dict[str, Topic] = {}
    for topic in topics:
        if topic.type in known:
            by_name.setdefault(topic.name, topic)
    kept: list[BagMessage] = []
    for message in messages:
        if message.topic in by_name and by_name[message.topic].type == message.type:
            # What cannot be decompressed is damaged, as a chunk with a wrong checksum is.
            with contextlib.suppress(Exception):
                kept.append(replace(message, data=plain(message.data)))
    return list(by_name.values()), kept
