"""Making a bag whole whose recording was killed."""

from __future__ import annotations

import sqlite3
import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader

from al_questioner.recording.bags import BagError, BagMessage, Topic, read_bag, storage_files
from al_questioner.recording.writing import BagWriter


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

    Args:
        path: directory of the bag.

    Raises:
        BagError: no bag, nothing readable in it, or its directory cannot be written to.
    """
    try:
        whole = read_bag(path)
    except BagError as error:
        files = list(storage_files(path)) if path.is_dir() else []
        if not files:
            raise
        if len(files) > 1:
            raise BagError(f'{path}: a bag of {len(files)} files cannot be repaired') from error
        return _rewrite(path, files[0])
    return RepairReport(True, Counter(message.topic for message in whole.messages))


def _rewrite(path: Path, broken: Path) -> RepairReport:
    topics, messages = _salvage(broken)
    if not messages:
        raise BagError(f'{path}: no message can be read from {broken.name}')
    storage = 'mcap' if broken.suffix == '.mcap' else 'sqlite3'
    kept_as = broken.with_name(f'{broken.name}.broken')
    if kept_as.exists():
        raise BagError(f'{kept_as}: exists already; move it away to repair once more')
    try:
        with tempfile.TemporaryDirectory(dir=path.parent, prefix='.repairing-') as folder:
            # A bag's file bears the name of its directory, also inside.
            rewritten = Path(folder) / path.name
            with BagWriter(rewritten, topics, storage) as writer:
                for message in messages:
                    writer.write(message.topic, message.data, message.stamp)
            broken.rename(kept_as)
            for file in (*storage_files(rewritten), rewritten / 'metadata.yaml'):
                file.rename(path / file.name)
    except OSError as error:
        raise BagError(f'{path}: cannot be repaired ({error.strerror})') from error
    return RepairReport(False, Counter(message.topic for message in messages), kept_as)


def _salvage(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    """Topics and messages of a storage file, as far as it can be read."""
    return _salvage_mcap(file) if file.suffix == '.mcap' else _salvage_sqlite3(file)


def _salvage_mcap(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    schemas: dict[int, Schema] = {}
    channels: dict[int, Channel] = {}
    messages: list[BagMessage] = []
    for record in _complete_records(file):
        if isinstance(record, Schema):
            schemas[record.id] = record
        elif isinstance(record, Channel):
            channels[record.id] = record
        elif isinstance(record, Message) and record.channel_id in channels:
            channel = channels[record.channel_id]
            type_ = schemas[channel.schema_id].name
            messages.append(BagMessage(channel.topic, type_, record.log_time, record.data))
    topics = [
        Topic(channel.topic, schemas[channel.schema_id].name, _is_latched(channel.metadata))
        for channel in channels.values()
    ]
    return topics, messages


def _is_latched(metadata: Mapping[str, str]) -> bool:
    return 'durability: transient_local' in metadata.get('offered_qos_profiles', '')


def _complete_records(file: Path) -> Iterator[object]:
    """The records up to the first that is not complete."""
    with file.open('rb') as stream:
        try:
            yield from StreamReader(stream, validate_crcs=False).records
        except Exception:  # noqa: BLE001 - a record that was cut off fails in as many ways as it has fields
            return


def _salvage_sqlite3(file: Path) -> tuple[list[Topic], list[BagMessage]]:
    topics: list[Topic] = []
    messages: list[BagMessage] = []
    try:
        # Closed at once: its journal must not be taken for that of the new file.
        with closing(sqlite3.connect(file)) as database:
            rows = database.execute('SELECT id, name, type, offered_qos_profiles FROM topics').fetchall()
            named = {number: Topic(name, type_, 'transient_local' in qos) for number, name, type_, qos in rows}
            topics = list(named.values())
            for number, stamp, data in database.execute('SELECT topic_id, timestamp, data FROM messages ORDER BY id'):
                if number in named:
                    messages.append(BagMessage(named[number].name, named[number].type, stamp, data))
    except sqlite3.Error:
        # What was read before the broken page is kept.
        pass
    return topics, messages
