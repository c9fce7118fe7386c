"""Time stamps as whole nanoseconds since the epoch of their clock."""

from __future__ import annotations

from typing import Any

SECOND = 1_000_000_000
"""Nanoseconds."""


def nanoseconds(stamp: Any) -> int:
    """A stamp of a message, which has `sec` and `nanosec`."""
    return int(stamp.sec) * SECOND + int(stamp.nanosec)


def stamp_members(stamp: int) -> dict[str, int]:
    """A stamp in nanoseconds as the member of a document."""
    return {'sec': stamp // SECOND, 'nanosec': stamp % SECOND}


def stamp_of(members: dict[str, Any]) -> int:
    """The inverse of `stamp_members`."""
    return int(members['sec']) * SECOND + int(members['nanosec'])
