"""Bags as written, read, killed and repaired."""

from __future__ import annotations

import contextlib
import os
import sqlite3
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml
from mcap.reader import make_reader

from al_questioner.bags import BagError, BagWriter, Topic, deserialize, digest, read_bag, repair, writing
from shared.bags import STRING, TOPICS, text, write
from shared.little_room import little_room


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_what_is_written_is_read(tmp_path, storage):
    """Otherwise a demonstration would not be the one that was given."""
    bag = read_bag(write(tmp_path / 'b', storage=storage))
    assert [deserialize(message).data for message in bag.messages] == list('0123456789')
    assert [message.stamp for message in bag.messages] == list(range(1000, 1010))
    assert set(bag.topics) == set(TOPICS)


def test_an_mcap_bag_is_what_rosbag2_writes(tmp_path):
    """`ros2 bag` and Foxglove can read it: held against the mcap library and the documented metadata."""
    path = write(tmp_path / 'b')
    with (path / 'b_0.mcap').open('rb') as file:
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        found = [(schema.name, channel.topic, message.log_time) for schema, channel, message in reader.iter_messages()]
        assert reader.get_header().profile == 'ros2'
    assert found[3] == (STRING, '/x/turn', 1003)
    assert summary.statistics.message_count == 10
    (schema,) = summary.schemas.values()
    assert (schema.name, schema.encoding) == (STRING, 'ros2msg')
    assert b'string data' in schema.data
    hashes = set()
    for channel in summary.channels.values():
        assert channel.message_encoding == 'cdr'
        assert list(channel.metadata) == ['offered_qos_profiles', 'topic_type_hash']
        hashes.add(channel.metadata['topic_type_hash'])
    information = yaml.safe_load((path / 'metadata.yaml').read_text())['rosbag2_bagfile_information']
    assert information['version'] == 9
    assert information['storage_identifier'] == 'mcap'
    assert information['relative_file_paths'] == ['b_0.mcap']
    turn, answer = (topic['topic_metadata'] for topic in information['topics_with_message_count'])
    assert turn['type_description_hash'].startswith('RIHS01_')
    assert hashes == {turn['type_description_hash'], answer['type_description_hash']}
    (profile,) = turn['offered_qos_profiles']
    assert (profile['durability'], profile['depth']) == ('transient_local', 1)
    assert answer['offered_qos_profiles'][0]['durability'] == 'volatile'


def test_a_sqlite3_bag_has_the_tables_of_rosbag2(tmp_path):
    """Otherwise `ros2 bag` would not read it."""
    path = write(tmp_path / 'b', storage='sqlite3')
    database = sqlite3.connect(path / 'b_0.db3')
    assert database.execute('SELECT schema_version FROM schema').fetchall() == [(4,)]
    assert database.execute('SELECT count(*) FROM messages').fetchall() == [(10,)]
    columns = [row[1] for row in database.execute('PRAGMA table_info(topics)')]
    assert columns == ['id', 'name', 'type', 'serialization_format', 'offered_qos_profiles', 'type_description_hash']
    database.close()


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize(
    ('environment', 'wheels', 'expected'),
    [
        ('kilted', ['ros-jazzy-rclpy'], 'kilted'),
        ('', ['numpy', 'ros-rclpy', 'ros-jazzy-rclpy', 'ros-jazzy-std-msgs'], 'jazzy'),
        ('', ['numpy'], ''),
    ],
    ids=['environment', 'wheels', 'unknown'],
)
def test_a_bag_names_the_distribution_that_it_was_recorded_with(
    tmp_path, monkeypatch, storage, environment, wheels, expected
):
    """Otherwise `ros2 bag info` would name one that does not exist, and converters look for its message types."""
    monkeypatch.setenv('ROS_DISTRO', environment)
    monkeypatch.setattr(writing, 'distributions', lambda: [SimpleNamespace(name=name) for name in wheels])
    writing.ros_distribution.cache_clear()
    try:
        path = write(tmp_path / 'b', storage=storage)
    finally:
        writing.ros_distribution.cache_clear()
    metadata = (path / 'metadata.yaml').read_text()
    assert yaml.safe_load(metadata)['rosbag2_bagfile_information']['ros_distro'] == expected
    if storage == 'sqlite3':
        with contextlib.closing(sqlite3.connect(path / 'b_0.db3')) as database:
            assert database.execute('SELECT ros_distro FROM schema').fetchall() == [(expected,)]
            ((inside,),) = database.execute('SELECT metadata FROM metadata').fetchall()
    else:
        with (path / 'b_0.mcap').open('rb') as file:
            (record,) = make_reader(file).iter_metadata()
        inside = record.metadata['serialized_metadata']
    assert yaml.safe_load(inside)['ros_distro'] == expected
    assert sorted(file.name for file in path.iterdir())[1:] == ['metadata.yaml']


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_bag_without_messages_is_finished_and_refused(tmp_path, storage):
    """An empty recording must not look like a broken one."""
    with pytest.raises(BagError, match='the bag is empty'):
        read_bag(write(tmp_path / 'b', 0, storage))


def test_a_bag_is_never_overwritten(tmp_path):
    """A demonstration with a person cannot be repeated."""
    path = write(tmp_path / 'b')
    before = digest(path)
    with pytest.raises(BagError, match='exists already'):
        BagWriter(path, TOPICS)
    (tmp_path / 'file').write_text('mine')
    with pytest.raises(BagError, match='exists already'):
        BagWriter(tmp_path / 'file', TOPICS)
    assert digest(path) == before


def test_what_cannot_be_written_is_said(tmp_path):
    """Otherwise the user would believe that a recording runs."""
    with pytest.raises(BagError, match=r"unknown storage 'bag'; known: mcap, sqlite3"):
        BagWriter(tmp_path / 'b', TOPICS, 'bag')
    with pytest.raises(BagError, match='no message type'):
        BagWriter(tmp_path / 'c', [Topic('/x', 'my_msgs/msg/Mine', False)])
    (tmp_path / 'file').write_text('')
    with pytest.raises(BagError, match='cannot be written'):
        BagWriter(tmp_path / 'file' / 'b', TOPICS)


def truncate(path):
    file = path / 'b_0.mcap'
    file.write_bytes(file.read_bytes()[:-100])


def miscount(path):
    metadata = (path / 'metadata.yaml').read_text()
    (path / 'metadata.yaml').write_text(metadata.replace('message_count: 10', 'message_count: 12'))


@pytest.mark.parametrize(
    ('damage', 'reason'),
    [
        (lambda path: (path / 'metadata.yaml').unlink(), r'metadata\.yaml is missing.*record --repair'),
        (truncate, r'cannot be read \(.*record --repair'),
        (miscount, r'messages are missing: 10 of 12 on /x/turn'),
        (lambda path: (path / 'metadata.yaml').write_text('a: ['), 'cannot be read'),
        (lambda path: (path / 'metadata.yaml').write_text('[]'), 'cannot be read'),
        (lambda path: (path / 'b_0.mcap').unlink(), 'cannot be read'),
        (lambda path: (path / 'b_0.mcap').write_bytes(b'nothing'), 'cannot be read'),
    ],
)
def test_a_broken_bag_is_one_clear_line(tmp_path, damage, reason):
    """Otherwise half a demonstration would be learnt from in silence, or a traceback be all that the user sees."""
    path = write(tmp_path / 'b')
    damage(path)
    with pytest.raises(BagError, match=reason) as raised:
        read_bag(path)
    assert '\n' not in str(raised.value)
    assert str(path) in str(raised.value)


def test_what_is_no_bag_is_said(tmp_path):
    """The user has mistyped."""
    (tmp_path / 'notes.txt').write_text('hello')
    for name, reason in (('missing', 'there is no such bag'), ('.', 'is no bag'), ('notes.txt', 'is no bag')):
        with pytest.raises(BagError, match=reason):
            read_bag(tmp_path / name)


def test_bytes_of_another_type_are_refused(tmp_path):
    """Otherwise garbage would be learnt from."""
    with BagWriter(tmp_path / 'b', TOPICS) as bag:
        bag.write('/x/turn', b'\x00\x01\x00\x00\xff\xff\xff\x7f', 5)
    (message,) = read_bag(tmp_path / 'b').messages
    with pytest.raises(BagError, match=r'/x/turn: not a std_msgs/msg/String'):
        deserialize(message)


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_another_thread_can_write_and_close(tmp_path, storage):
    """The recorder's worker writes to what its constructor opened, which SQLite alone refuses."""
    with BagWriter(tmp_path / 'b', TOPICS, storage) as bag:
        thread = threading.Thread(target=lambda: (bag.write('/x/turn', text('a'), 1), bag.sync()))
        thread.start()
        thread.join()
    assert len(read_bag(tmp_path / 'b').messages) == 1


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_full_disk_is_one_error_and_what_was_written_stays(tmp_path, storage):
    """Otherwise a recording would be finished with a hole in it, or end in an error that nobody expects."""
    path = tmp_path / 'b'
    bag = BagWriter(path, TOPICS, storage)
    for number in range(50):
        bag.write('/x/turn', text('x' * 1000), number)
    bag.sync()
    with little_room(200_000), pytest.raises(OSError, match=r'large|full|I/O'):
        fill(bag)
    with pytest.raises(OSError, match='closed'):
        bag.write('/x/turn', text('later'), 10_000)
    bag.close()
    with pytest.raises(BagError, match='record --repair'):
        read_bag(path)
    assert repair(path).kept['/x/turn'] >= 50


def fill(bag):
    """Write much more than there is room for."""
    for number in range(50, 1000):
        bag.write('/x/turn', text('x' * 1000), number)
        bag.sync()


def test_writing_after_the_end_is_an_error(tmp_path):
    """Otherwise messages would vanish."""
    bag = BagWriter(tmp_path / 'b', TOPICS)
    bag.write('/x/turn', text('a'), 1)
    bag.close()
    bag.close()
    with pytest.raises(OSError, match='closed'):
        bag.sync()


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('room', [0, 1000])
def test_nothing_is_left_of_a_bag_that_there_was_no_room_for(tmp_path, storage, room):
    """Otherwise the next try would be told that the bag exists already, and a repair find no message in it."""
    path, full = tmp_path / 'b', pytest.raises((OSError, BagError), match=r'large|full|I/O')
    with little_room(room), full, BagWriter(path, TOPICS, storage) as bag:
        fill(bag)
    assert not path.exists()


def test_what_is_neither_a_file_nor_a_folder_is_no_bag(tmp_path):
    """Otherwise it would be a traceback, or wait for a writer who never comes."""
    os.mkfifo(tmp_path / 'pipe')
    (tmp_path / 'folder').mkdir()
    os.mkfifo(tmp_path / 'folder' / 'b_0.mcap')
    for path in (Path('/dev/null'), tmp_path / 'pipe', tmp_path / 'folder'):
        for use in (read_bag, repair):
            with pytest.raises(BagError, match='is no bag, but a device or a pipe'):
                use(path)
