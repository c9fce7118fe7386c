"""Writing files, with errors that a user understands."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path

from al_questioner.domain import InputError


def make_folder(path: Path) -> None:
    """Make a folder and those it lies in.

    Raises:
        InputError: it cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f'{path} cannot be made a folder ({error.strerror})') from error


def check_writable(path: Path) -> None:
    """See whether a file could be written, without leaving one or touching what is there.

    Raises:
        InputError: it could not.
    """
    folders = [folder for folder in path.parents if not folder.exists()]
    make_folder(path.parent)
    with _naming(path):
        draft = _draft(path)
        draft.open('ab').close()
        if draft != path:
            draft.unlink()
    for folder in folders:
        folder.rmdir()


def write_text(path: Path, text: str) -> None:
    """Write a file as a whole, or leave what is there; half of a character, which only JSON can say, becomes `?`.

    Raises:
        InputError: it cannot be written.
    """
    write_bytes(path, text.encode(errors='replace'))


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file as a whole, or leave what is there; the folders it lies in are made, or left out with it.

    Raises:
        InputError: it cannot be written.
    """
    made = [folder for folder in path.parents if not folder.exists()]
    make_folder(path.parent)
    with _naming(path):
        try:
            _write_whole(path, content)
        except OSError:
            with contextlib.suppress(OSError):
                for folder in made:
                    folder.rmdir()
            raise


def _write_whole(path: Path, content: bytes) -> None:
    draft = _draft(path)
    try:
        draft.write_bytes(content)
        if draft != path:
            # A link stays a link.
            draft.replace(path.resolve())
    finally:
        if draft != path:
            draft.unlink(missing_ok=True)


def _draft(path: Path) -> Path:
    """A file beside another one, to be renamed to it once it is whole; a device or a pipe itself.

    Raises:
        OSError: the other one may not be written.
    """
    target = path.resolve()
    if target.exists():
        if not target.is_file():
            return path
        target.open('ab').close()
    return target.with_name(f'.draft-{os.getpid()}-{threading.get_ident()}')


@contextlib.contextmanager
def _naming(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f'{path} cannot be written ({error.strerror or error})') from error


def sync_to_disk(path: Path) -> None:
    """Bring a file, or the names in a folder, to the disk.

    Raises:
        OSError: it cannot be.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
