"""Bags as other tools write, index, split and compress them."""

from __future__ import annotations

import io
import shutil

import pytest
import yaml
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer

from al_questioner.bags import BagError, BagWriter, read_bag
from al_questioner.bags.reading import typestore
from shared.bags import STRING, TOPICS, make_old, text, write

INFORMATION = 'rosbag2_bagfile_information'


def change_metadata(path, change):
    metadata = yaml.safe_load((path / 'metadata.yaml').read_text())
    change(metadata[INFORMATION])
    (path / 'metadata.yaml').write_text(yaml.safe_dump(metadata))


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize(
    ('member', 'value'),
    [('offered_qos_profiles', []), ('offered_qos_profiles', ''), ('type_description_hash', 'RIHS01_00')],
)
def test_metadata_that_describe_the_topics_otherwise_lose_nothing(tmp_path, storage, member, value):
    """Otherwise after `ros2 bag reindex` all messages would be missing."""
    path = write(tmp_path / 'b', storage=storage)

    def change(information):
        for topic in information['topics_with_message_count']:
            topic['topic_metadata'][member] = value

    change_metadata(path, change)
    bag = read_bag(path)
    assert len(bag.messages) == 10
    assert set(bag.topics) == set(TOPICS)


def test_a_table_of_the_first_versions_is_read(tmp_path):
    """Recordings of years ago, and what converters of today write."""
    path = write(tmp_path / 'b', storage='sqlite3')
    make_old(path / 'b_0.db3')
    assert len(read_bag(path).messages) == 10


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize('mode', [CompressionMode.MESSAGE, CompressionMode.FILE])
def test_compressed_bags_are_read(tmp_path, storage, mode):
    """Otherwise `ros2 bag record --compression-mode` would make recordings that nobody can learn from."""
    bag = Writer(tmp_path / 'b', version=9, storage_plugin=StoragePlugin[storage.upper()])
    bag.set_compression(mode, CompressionFormat.ZSTD)
    with bag:
        connection = bag.add_connection('/x/turn', STRING, typestore=typestore())
        for stamp in range(5):
            bag.write(connection, stamp, text(str(stamp)))
    assert [message.data for message in read_bag(tmp_path / 'b').messages] == [text(str(n)) for n in range(5)]
    (tmp_path / 'b' / 'metadata.yaml').unlink()
    if mode is CompressionMode.FILE:
        with pytest.raises(BagError, match='b: is compressed; decompress its file'):
            read_bag(tmp_path / 'b')


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
def test_the_files_of_a_split_bag_are_read_in_order(tmp_path, storage):
    """Long recordings are split; the tenth file is not the second."""
    path = tmp_path / 'b'
    path.mkdir()
    for number in range(11):
        part = write(tmp_path / f'part{number}', 2, storage, first=10 * number)
        (file,) = (file for file in part.iterdir() if file.name != 'metadata.yaml')
        shutil.move(file, path / f'b_{number}{file.suffix}')
    shutil.copy(part / 'metadata.yaml', path)

    def change(information):
        information['relative_file_paths'] = [f'b_{number}{file.suffix}' for number in range(11)]
        for topic in information['topics_with_message_count']:
            topic['message_count'] *= 11

    change_metadata(path, change)
    stamps = [message.stamp for message in read_bag(path).messages]
    assert stamps == [10 * number + more for number in range(11) for more in (0, 1)]


@pytest.mark.parametrize('storage', ['mcap', 'sqlite3'])
@pytest.mark.parametrize(
    ('received', 'expected'),
    [
        ([('/x/turn', 3), ('/x/turn', 4), ('/x/answer', 1), ('/x/answer', 5)], [1, 3, 4, 5]),
        ([('/x/turn', 3), ('/x/answer', 4), ('/x/turn', 1), ('/x/answer', 5)], [3, 4, 1, 5]),
        ([('/x/turn', 0), ('/x/answer', 0), ('/x/turn', 0)], [0, 0, 0]),
    ],
    ids=['topic after topic', 'a clock that was put back', 'no stamps'],
)
def test_messages_come_in_the_order_in_which_they_were_received(tmp_path, storage, received, expected):
    """Otherwise a recording would be played, and learnt from, in an order that never was."""
    with BagWriter(tmp_path / 'b', TOPICS, storage) as bag:
        for topic, stamp in received:
            bag.write(topic, text('a'), stamp)
    assert [message.stamp for message in read_bag(tmp_path / 'b').messages] == expected


def test_bags_of_ros_1_are_named_as_such(tmp_path):
    """The message says ROS 1, and does not advise a repair."""
    old = tmp_path / 'old'
    old.mkdir()
    (old / 'run.bag').write_bytes(b'#ROSBAG V2.0\n' + bytes(100))
    for path in (old, old / 'run.bag'):
        with pytest.raises(BagError, match=r'run.bag: is a bag of ROS 1, not of ROS 2; convert it: rosbags-convert'):
            read_bag(path)
    stream = io.BytesIO()
    mcap = McapWriter(stream)
    mcap.start(profile='ros1')
    mcap.finish()
    (tmp_path / 'old.mcap').write_bytes(stream.getvalue())
    with pytest.raises(BagError, match=r'old.mcap: is a bag of ROS 1, not of ROS 2$'):
        read_bag(tmp_path / 'old.mcap')
