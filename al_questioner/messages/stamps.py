"""Time stamps as whole nanoseconds since the epoch of their clock."""

from __future__ import annotations

from typing import Any

SECOND = 1_000_000_000
"""One second in nanoseconds."""


def nanoseconds(stamp: Any) -> int:
    """Return the stamp of a message, which has `sec` and `nanosec`, in nanoseconds."""
    return int(stamp.sec) * SECOND + int(stamp.nanosec)


def stamp_members(stamp: int) -> dict[str, int]:
    """Return a stamp in nanoseconds as the object that a JSON document holds."""
    return {'sec': stamp // SECOND, 'nanosec': stamp % SECOND}


def stamp_of(members: dict[str, Any]) -> int:
    """Return the nanoseconds of such an object, as the inverse of `stamp_members`."""
    return int(members['sec']) * SECOND + int(members['nanosec'])
