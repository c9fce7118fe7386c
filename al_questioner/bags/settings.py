"""Setting of the files of a bag."""

from __future__ import annotations

from al_questioner.domain import Setting

STORAGE_SUFFIXES = {'mcap': '.mcap', 'sqlite3': '.db3'}
"""Suffix of a bag's file by the name of its storage."""
STORAGE = Setting(
    'storage', 'mcap', f'format of the file: {" or ".join(STORAGE_SUFFIXES)}', choices=tuple(STORAGE_SUFFIXES)
)
