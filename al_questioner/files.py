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
