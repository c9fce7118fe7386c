"""A file is written as a whole, or what was there stays; whatever is in the way is one line."""

from __future__ import annotations

import errno
import os
import resource
from collections.abc import Iterator
from pathlib import Path

import pytest
from matplotlib import pyplot as plt

from al_questioner.domain import InputError
from al_questioner.support.files import check_writable, write_bytes, write_text
from al_questioner.support.plotting import save


@pytest.fixture
def small_files() -> Iterator[None]:
    """No file may grow beyond 1000 bytes: what a full disk is to a writer."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_file_that_there_is_no_room_for_leaves_the_old_one(tmp_path: Path, small_files: None) -> None:
    """Neither half a table is left, nor an empty one in place of that of yesterday, nor a folder made for it."""
    path = tmp_path / 'table.csv'
    write_text(path, 'of yesterday\n')
    with pytest.raises(InputError, match=r'table\.csv cannot be written \(File too large\)'):
        write_text(path, 'of today\n' * 1000)
    assert path.read_text() == 'of yesterday\n'
    for new in ('new.csv', 'made/for/new.csv'):
        with pytest.raises(InputError, match=r'new\.csv cannot be written'):
            write_text(tmp_path / new, 'of today\n' * 1000)
    assert [each.name for each in tmp_path.iterdir()] == ['table.csv']


def test_a_figure_that_there_is_no_room_for_leaves_nothing(tmp_path: Path, small_files: None) -> None:
    """Otherwise a picture that no viewer opens would be left."""
    with pytest.raises(InputError, match=r'figure\.png cannot be written'):
        save(plt.figure(), tmp_path / 'figure.png')
    assert list(tmp_path.iterdir()) == []


def test_a_full_device_is_one_line() -> None:
    with pytest.raises(InputError, match=r'^/dev/full cannot be written \(No space left on device\)$'):
        write_text(Path('/dev/full'), 'content')


def test_a_device_or_a_pipe_is_written_to_itself(tmp_path: Path) -> None:
    """Otherwise `--json /dev/stdout`, or a named pipe, would be replaced by a file."""
    pipe = tmp_path / 'pipe'
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    check_writable(pipe)
    write_text(pipe, 'content')
    assert os.read(reader, 100) == b'content'
    os.close(reader)
    assert pipe.is_fifo()


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    target, link = tmp_path / 'folder' / 'target', tmp_path / 'link'
    write_text(target, 'old')
    link.symlink_to(target)
    write_text(link, 'new')
    assert link.is_symlink()
    assert target.read_text() == 'new'


def test_what_may_not_be_written_is_not_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Renaming asks for the folder's permission alone."""
    path = tmp_path / 'mine'
    path.write_text('old')

    def refuse(self: Path, mode: str = 'r', **options: object) -> None:
        raise PermissionError(errno.EACCES, 'Permission denied')

    monkeypatch.setattr(Path, 'open', refuse)
    for write in (check_writable, lambda each: write_bytes(each, b'new')):
        with pytest.raises(InputError, match=r'mine cannot be written \(Permission denied\)'):
            write(path)
    monkeypatch.undo()
    assert path.read_text() == 'old'


def test_seeing_whether_one_could_write_leaves_no_trace(tmp_path: Path) -> None:
    path = tmp_path / 'a' / 'b' / 'new.json'
    check_writable(path)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match='cannot be written'):
        check_writable(tmp_path)


def test_half_a_character_becomes_a_question_mark(tmp_path: Path) -> None:
    """JSON can hold half a character, and UTF-8 cannot: no whole table is lost for it."""
    write_text(tmp_path / 'table', 'a\ud800b')
    assert (tmp_path / 'table').read_text() == 'a?b'
