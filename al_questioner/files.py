"""Writing files, with errors that a user understands."""

from __future__ import annotations

import os
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
    existed, folders = path.exists(), [folder for folder in path.parents if not folder.exists()]
    make_folder(path.parent)
    write_text(path, '', mode='a')
    if not existed:
        path.unlink()
    for folder in folders:
        folder.rmdir()


def write_text(path: Path, text: str, mode: str = 'w') -> None:
    """Write a file, or, with mode `a`, see whether one could.

    Raises:
        InputError: it cannot be written.
    """
    try:
        with path.open(mode, encoding='utf-8') as file:
            file.write(text)
    except OSError as error:
        raise InputError(f'{path} cannot be written ({error.strerror})') from error


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
