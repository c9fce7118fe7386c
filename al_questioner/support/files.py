"""Writing of files, with errors that a user understands."""

from __future__ import annotations

import contextlib
import os
import threading
from collections.abc import Iterator
from pathlib import Path

from al_questioner.domain import InputError


def make_folder(path: Path) -> None:
    """Make a folder and its parents.

    Raises:
        InputError: the folder cannot be made.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f'{path} cannot be made a folder ({error.strerror})') from error


def check_writable(path: Path) -> None:
    """Check that a file could be written, without leaving one and without changing an existing one.

    Raises:
        InputError: it could not be written.
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
    """Write a text file completely, or leave the old file as it is.

    A lone surrogate, which only JSON can express, becomes `?`.

    Raises:
        InputError: it cannot be written.
    """
    write_bytes(path, text.encode(errors='replace'))


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file completely, or leave the old file as it is; missing folders are made, and removed after a failure.

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
            # Replace the target, so that a link stays a link.
            draft.replace(path.resolve())
    finally:
        if draft != path:
            draft.unlink(missing_ok=True)


def _draft(path: Path) -> Path:
    """Return a path beside a file, for a draft that is renamed to the file once it is complete.

    For a device or a pipe, return the path itself.

    Raises:
        OSError: the file may not be written.
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
    """Flush a file, or the names in a folder, to the disk.

    Raises:
        OSError: it cannot be.
    """
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
