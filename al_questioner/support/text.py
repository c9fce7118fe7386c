"""Small change of plain English."""

from __future__ import annotations


def number_of(count: int, one: str, many: str = '') -> str:
    """A number of things: `1 turn`, `2 turns`; `many` is the plural of a noun that does not just take an s."""
    return f'{count} {one if count == 1 else many or one + "s"}'
