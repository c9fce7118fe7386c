"""Repair of a bag after its recording was killed."""

from __future__ import annotations

import contextlib
import re
import sqlite3
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from mcap.records import Channel, Chunk, Message, Schema
from mcap.stream_reader import StreamReader, breakup_chunk

from al_questioner.bags.reading import BagError, BagMessage, Topic, read_bag, typestore
from al_questioner.bags.storages import BROKEN, COMPRESSED, holds_messages, place_of, plain, storage_files
from al_questioner.bags.writing import FIRST, BagWriter
from al_questioner.support.files import sync_to_disk


@dataclass(frozen=True)
class RepairReport:
    """Result of a repair: whether nothing had to be done, and the number of messages kept, by topic.

    `originals` are the broken files, which were kept under other names.
    """

    was_whole: bool
    kept: Mapping[str, int]
    originals: tuple[Path, ...] = ()


def repair(path: Path) -> RepairReport:
    """Rewrite a bag, of one file or several, as one file of every message that reached the disk.

    A complete bag is not changed. A repair that is itself interrupted can be repeated.

    Raises:
        BagError: no bag, nothing readable in it, or its directory cannot be written to.
    """
    try:
        whole = read_bag(path)
    except BagError as error:
        files = _broken_files(path) if path.is_dir() else []
        if files:
            return _rewrite(path, files)
        if (path / 'metadata.yaml').is_file():
            raise BagError(f'{error}; nothing can be recovered') from error
        raise
    return RepairReport(True, Counter(message.topic for message in whole.messages))


def _broken_files(path: Path) -> list[Path]:
    """Return the files to repair a bag from, in order; an interrupted repair may have renamed some or all of them.

    Raises:
        BagError: there are files of an earlier repair, or files that do not belong together.
    """
    files, kept = list(storage_files(path)), [*filter(Path.is_file, path.glob(f'*{BROKEN}'))]
    if any(_kept_as(file) in kept for file in files):
        names = ', '.join(file.name for file in sorted(kept))
        raise BagError(f'{path}: {names}: kept by an earlier repair; move away to repair once more')
    files = sorted([*files, *kept], key=lambda file: place_of(file.name))
    if len({file.name.removesuffix(BROKEN).rpartition('.')[2] for file in files}) > 1:
        raise BagError(f'{path}: cannot be repaired, as its files are of different kinds')
    compressed = [file.name for file in path.iterdir() if file.suffix == COMPRESSED and holds_messages(file)]
    if files and compressed:
        raise BagError(f'{path}: is compressed in part; decompress {", ".join(sorted(compressed))} (unzstd) first')
    return files


def _kept_as(file: Path) -> Path:
    return file.with_name(file.name.removesuffix(BROKEN) + BROKEN)


def _rewrite(path: Path, broken: Sequence[Path]) -> RepairReport:
    """Write one file with all that can be read from the broken ones."""
    name = broken[0].name.removesuffix(BROKEN)
    is_mcap = name.endswith('.mcap')
    try:
        found = [_salvage_mcap(file) if is_mcap else _salvage_sqlite3(file) for file in broken]
        topics, messages = _consistent(
            [topic for topics, _ in found for topic in topics], [message for _, some in found for message in some]
        )
        if not messages:
            raise BagError(f'{path}: no message can be read from {", ".join(file.name for file in broken)}')
        with tempfile.TemporaryDirectory(dir=path, prefix='.repairing-') as folder:
            rewritten = Path(folder) / Path(name).stem.removesuffix(FIRST)
            with BagWriter(rewritten, topics, 'mcap' if is_mcap else 'sqlite3') as writer:
                for message in messages:
                    writer.write(message.topic, message.data, message.stamp)
            for file in broken:
                file.rename(_kept_as(file))
            # The messages come last: until they are there, the bag is detected as broken.
            for file in (rewritten / 'metadata.yaml', *storage_files(rewritten)):
                file.replace(path / file.name)
        sync_to_disk(path)
    except OSError as error:
        raise BagError(f'{path}: cannot be repaired ({error.strerror})') from error
    return RepairReport(False, Counter(message.topic for message in messages), tuple(map(_kept_as, broken)))


def _salvage_mcap(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    """Return the topics and messages of a file, as far as it can be read."""
    schemas: dict[int, Schema] = {}
    topics: dict[int, Topic] = {}
    found: list[Message] = []
    for record in _complete_records(file):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel) and record.schema_id in schemas:
            latched = _is_latched(record.metadata.get('offered_qos_profiles', ''))
            topics[record.id] = Topic(record.topic, schemas[record.schema_id].name, latched)
        elif isinstance(record, Message):
            found.append(record)
    # Only after the whole file, because its end repeats the channels that a broken chunk may have lost.
    messages = [
        BagMessage(topics[message.channel_id].name, topics[message.channel_id].type, message.log_time, message.data)
        for message in found
        if message.channel_id in topics
    ]
    return list(topics.values()), messages


def _is_latched(offered_qos_profiles: str) -> bool:
    """Return whether a profile is transient local, by its name or by the number that earlier versions wrote."""
    return re.search(r'durability: (transient_local|1)\b', offered_qos_profiles) is not None


def _complete_records(file: Path) -> Iterator[object]:
    """Yield the records before the first incomplete one, without the chunks whose checksum is wrong."""
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
    """Return the topics and messages of a file, as far as it can be read."""
    topics: dict[int, Topic] = {}
    messages: list[BagMessage] = []
    try:
        # Closed at once, because its journal must not be taken for that of the new file.
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
        # The rows before the broken page are kept.
        pass
    return list(topics.values()), messages


def _consistent(topics: Iterable[Topic], messages: Iterable[BagMessage]) -> tuple[list[Topic], list[BagMessage]]:
    """Return one topic of each name, of a type that can be written, and its messages."""
    known = typestore().fielddefs
    by_name: dict[str, Topic] = {}
    for topic in topics:
        if topic.type in known:
            by_name.setdefault(topic.name, topic)
    kept: list[BagMessage] = []
    for message in messages:
        if message.topic in by_name and by_name[message.topic].type == message.type:
            # Data that cannot be decompressed is damaged, like a chunk with a wrong checksum.
            with contextlib.suppress(Exception):
                kept.append(replace(message, data=plain(message.data)))
    return list(by_name.values()), kept
