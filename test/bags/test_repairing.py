"""Bags that were killed, cut or damaged, and repaired."""

from __future__ import annotations

import contextlib
import random
import shutil
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, Reader, StoragePlugin, Writer

from al_questioner.bags import BagError, BagWriter, read_bag, repair
from al_questioner.bags.reading import typestore
from shared.bags import STRING, TOPICS, make_old, text, write

KILLED = """
import sys, time
from pathlib import Path
from al_questioner.bags import BagWriter, Topic
bag = BagWriter(Path(sys.argv[1]), [Topic('/x/turn', 'std_msgs/msg/String', True)], sys.argv[2])
for number in range(50):
    bag.write('/x/turn', b'\\x00\\x01\\x00\\x00\\x02\\x00\\x00\\x00a\\x00', 1000 + number)
    if number == 39:
        bag.sync()
print('ready', flush=True)
time.sleep(60)
"""


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_killed_recording_is_repaired(tmp_path, storage):
    """All that was synced before SIGKILL is there; a rosbags writer alone would lose all."""
    path = tmp_path / 'b'
    process = subprocess.Popen([sys.executable, '-c', KILLED, str(path), storage], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b'ready\n'
    process.kill()
    assert process.wait() == -signal.SIGKILL
    process.stdout.close()
    with pytest.raises(BagError, match='record --repair'):
        read_bag(path)
    report = repair(path)
    assert not report.was_whole
    assert report.kept['/x/turn'] == 40
    assert report.originals[0].is_file()
    assert [message.stamp for message in read_bag(path).messages] == list(range(1000, 1040))
    with Reader(path) as reader:
        assert reader.message_count == 40
    again = repair(path)
    assert (again.was_whole, again.kept['/x/turn']) == (True, 40)


@pytest.mark.parametrize('number', [0, 5])
def test_a_flipped_bit_is_found_and_costs_one_chunk(tmp_path, number):
    """Otherwise a worn disk would give another demonstration, or repairing would lose all of it."""
    path = tmp_path / 'b'
    with BagWriter(path, TOPICS) as bag:
        for stamp in range(9):
            bag.write('/x/turn', text(f'message {stamp}'), stamp)
            bag.sync()
    file = path / 'b_0.mcap'
    file.write_bytes(file.read_bytes().replace(b'message %d' % number, b'massage %d' % number))
    with pytest.raises(BagError, match=r'checksum.*record --repair'):
        read_bag(path)
    assert repair(path).kept['/x/turn'] == 8
    assert [message.stamp for message in read_bag(path).messages] == [n for n in range(9) if n != number]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_an_interrupted_repair_can_be_repeated(tmp_path, storage):
    """Otherwise the only copy of a demonstration would be out of reach."""
    path = write(tmp_path / 'b', storage=storage)
    (file,) = path.glob('b_0.*')
    kept_as = file.rename(f'{file}.broken')
    for with_metadata in (True, False):
        if with_metadata:
            with pytest.raises(BagError, match='record --repair'):
                read_bag(path)
        else:
            (path / 'metadata.yaml').unlink()
            file.unlink()
        report = repair(path)
        assert (report.kept['/x/turn'], report.originals) == (10, (kept_as,))
        assert len(read_bag(path).messages) == 10
        assert sorted(path.iterdir()) == sorted([file, kept_as, path / 'metadata.yaml'])


def test_a_bag_is_repaired_from_inside_its_folder_and_under_another_name(tmp_path, monkeypatch):
    """People move recordings, and stand where they look."""
    path = write(tmp_path / 'b').rename(tmp_path / 'moved')
    (path / 'metadata.yaml').unlink()
    monkeypatch.chdir(path)
    assert repair(Path()).kept['/x/turn'] == 10
    assert len(read_bag(path).messages) == 10


def test_an_original_that_was_kept_is_not_overwritten(tmp_path):
    """Otherwise a second repair would destroy what the first one could not read."""
    path = write(tmp_path / 'b')
    (path / 'b_0.mcap.broken').write_bytes(b'precious')
    (path / 'metadata.yaml').unlink()
    with pytest.raises(BagError, match=r'b_0\.mcap\.broken: kept by an earlier repair; move away'):
        repair(path)
    assert (path / 'b_0.mcap.broken').read_bytes() == b'precious'


def test_topics_without_a_usable_type_are_left_out(tmp_path):
    """Otherwise one broken record would keep the user from all the others."""
    path = tmp_path / 'm'
    path.mkdir()
    with (path / 'm.mcap').open('wb') as file:
        mcap = McapWriter(file)
        mcap.start(profile='ros2')
        schema = mcap.register_schema(STRING, 'ros2msg', b'string data')
        for topic, schema_id in (('/x/turn', schema), ('/x/nothing', 0), ('/x/lost', 77)):
            channel = mcap.register_channel(topic, 'cdr', schema_id)
            mcap.add_message(channel, 5, text('a'), 5)
        mcap.finish()
    assert dict(repair(path).kept) == {'/x/turn': 1}
    path = tmp_path / 's'
    path.mkdir()
    with contextlib.closing(sqlite3.connect(path / 's.db3')) as database:
        database.execute('CREATE TABLE topics(id, name, type, offered_qos_profiles)')
        database.execute('CREATE TABLE messages(id, topic_id, timestamp, data)')
        topics = [
            (1, '/x/turn', STRING, ''),
            (2, '/x/null', STRING, None),
            (3, None, 7, ''),
            (4, '/x/my', 'a/msg/B', ''),
        ]
        database.executemany('INSERT INTO topics VALUES(?, ?, ?, ?)', topics)
        rows = [(n, n, 5, text('a')) for n in range(1, 6)] + [(6, 1, 'soon', text('b')), (7, 1, 6, None)]
        database.executemany('INSERT INTO messages VALUES(?, ?, ?, ?)', rows)
        database.commit()
    assert dict(repair(path).kept) == {'/x/turn': 1}


def test_a_table_of_the_first_versions_is_repaired(tmp_path):
    """All messages are there; only what was not yet recorded then is missing."""
    path = write(tmp_path / 'b', storage='sqlite3')
    (path / 'metadata.yaml').unlink()
    make_old(path / 'b_0.db3')
    assert repair(path).kept['/x/turn'] == 10
    assert [message.stamp for message in read_bag(path).messages] == list(range(1000, 1010))


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_messages_that_were_compressed_one_by_one_are_repaired(tmp_path, storage):
    """Otherwise the bag would be made whole with messages in it that nothing can read."""
    path = tmp_path / 'b'
    bag = Writer(path, version=9, storage_plugin=StoragePlugin[storage.upper()])
    bag.set_compression(CompressionMode.MESSAGE, CompressionFormat.ZSTD)
    with bag:
        connection = bag.add_connection('/x/turn', STRING, typestore=typestore())
        bag.write(connection, 5, text('a'))
    (path / 'metadata.yaml').unlink()
    assert repair(path).kept['/x/turn'] == 1
    (message,) = read_bag(path).messages
    assert message.data == text('a')


@pytest.mark.parametrize('profiles', ['- durability: 1\n  depth: 1', '- depth: 1\n  durability: transient_local'])
def test_what_was_latched_stays_so_when_it_is_repaired(tmp_path, profiles):
    """A late subscriber to a replay gets the latched messages; earlier versions wrote numbers."""
    path = write(tmp_path / 'b', storage='sqlite3')
    (path / 'metadata.yaml').unlink()
    with contextlib.closing(sqlite3.connect(path / 'b_0.db3')) as database:
        database.execute('UPDATE topics SET offered_qos_profiles = ?', (profiles,))
        database.commit()
    repair(path)
    assert {topic.latched for topic in read_bag(path).topics} == {True}


def overwrite(content, chance):
    """The content with a few flipped bits, or a hole, or cut off."""
    content, where = bytearray(content), chance.randrange(len(content))
    damage = chance.randrange(3)
    if damage == 0:
        content[where] ^= 1 << chance.randrange(8)
    elif damage == 1:
        content[where : where + 64] = bytes(len(content[where : where + 64]))
    else:
        del content[where:]
    return bytes(content)


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('copies', [15, pytest.param(60, marks=pytest.mark.slow)])
def test_no_damage_ends_in_another_error(tmp_path, storage, copies):
    """Otherwise the user would see a traceback instead of what can be done."""
    whole = write(tmp_path / 'whole' / 'b', storage=storage)
    chance = random.Random(0)
    for number in range(copies):
        path = shutil.copytree(whole, tmp_path / str(number) / 'b')
        (file,) = path.glob('b_0.*')
        file.write_bytes(overwrite(file.read_bytes(), chance))
        with contextlib.suppress(BagError):
            repair(path)
            read_bag(path)


@pytest.mark.parametrize('cut', [0.3, 0.5, 0.7, 0.9, 0.99])
def test_a_cut_file_is_repaired_as_far_as_it_goes(tmp_path, cut):
    """A full disk or a pulled plug ends a file anywhere."""
    path = tmp_path / 'b'
    with BagWriter(path, TOPICS) as bag:
        for number in range(200):
            bag.write('/x/turn', text('x' * 100), number)
            bag.sync()
    file = path / 'b_0.mcap'
    content = file.read_bytes()
    file.write_bytes(content[: int(cut * len(content))])
    kept = repair(path).kept['/x/turn']
    assert 0 < kept <= 200
    assert [message.stamp for message in read_bag(path).messages] == list(range(kept))


def test_what_cannot_be_repaired_is_said(tmp_path):
    """Nobody should wait for a demonstration that is gone."""
    with pytest.raises(BagError, match='is no bag'):
        repair(tmp_path)
    path = tmp_path / 'b'
    path.mkdir()
    (path / 'b_0.mcap').write_bytes(b'nothing')
    with pytest.raises(BagError, match='no message can be read'):
        repair(path)


def split(path, storage='mcap'):
    """A bag of three files of four messages each, as `ros2 bag record --max-bag-size` leaves it when it is killed."""
    path.mkdir()
    # 10 comes after 9, and not after 1.
    for place, number in enumerate((2, 9, 10)):
        with BagWriter(path.with_name('part'), TOPICS, storage) as bag:
            for stamp in range(4 * place, 4 * place + 4):
                bag.write('/x/turn', text(f'message {stamp}'), stamp)
                bag.sync()
        (file,) = path.with_name('part').glob('part_0.*')
        file.rename(path / f'b_{number}{file.suffix}')
        shutil.rmtree(path.with_name('part'))
    return path


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_a_bag_of_several_files_is_repaired(tmp_path, storage):
    """Otherwise the advice to repair it would be followed by a refusal."""
    path = split(tmp_path / 'b', storage)
    originals = {file.name: file.read_bytes() for file in path.iterdir()}
    with pytest.raises(BagError, match='record --repair'):
        read_bag(path)
    assert repair(path).kept['/x/turn'] == 12
    assert [message.stamp for message in read_bag(path).messages] == list(range(12))
    assert {file.name: file.read_bytes() for file in path.glob('*.broken')} == {
        f'{name}.broken': content for name, content in originals.items()
    }


def test_of_several_files_the_broken_ones_are_kept_as_far_as_they_go(tmp_path):
    path = split(tmp_path / 'b')
    file = path / 'b_9.mcap'
    file.write_bytes(file.read_bytes().replace(b'message 6', b'massage 6'))
    assert repair(path).kept['/x/turn'] == 11
    assert [message.stamp for message in read_bag(path).messages] == [*range(6), *range(7, 12)]


@pytest.mark.parametrize('renamed', [1, 2, 3])
def test_an_interrupted_repair_of_several_files_can_be_repeated(tmp_path, renamed):
    """The second repair finds the files that the first one renamed."""
    path = split(tmp_path / 'b')
    for number in (2, 9, 10)[:renamed]:
        (path / f'b_{number}.mcap').rename(path / f'b_{number}.mcap.broken')
    assert repair(path).kept['/x/turn'] == 12
    assert [message.stamp for message in read_bag(path).messages] == list(range(12))


def test_no_repair_is_advised_that_cannot_work(tmp_path):
    """Otherwise the advice would lead to a repair that gives the same advice."""
    path = tmp_path / 'b'
    bag = Writer(path, version=9)
    bag.set_compression(CompressionMode.FILE, CompressionFormat.ZSTD)
    with bag:
        bag.write(bag.add_connection('/x/turn', STRING, typestore=typestore()), 5, text('a'))
    (file,) = path.glob('*.zstd')
    file.write_bytes(file.read_bytes()[:-20])
    gone = write(tmp_path / 'gone')
    (gone / 'gone_0.mcap').unlink()
    for broken in (path, gone):
        with pytest.raises(BagError, match='cannot be read') as reading:
            read_bag(broken)
        with pytest.raises(BagError, match='nothing can be recovered') as repairing:
            repair(broken)
        assert '--repair' not in f'{reading.value}{repairing.value}'


def test_files_that_are_still_compressed_are_not_left_out_of_a_repair(tmp_path):
    """Otherwise a bag that was killed while a file was compressed would lose all files before."""
    path = split(tmp_path / 'b')
    (path / 'b_2.mcap').rename(path / 'b_2.mcap.zstd')
    with pytest.raises(BagError, match=r'decompress'):
        repair(path)
    assert not list(path.glob('*.broken'))
