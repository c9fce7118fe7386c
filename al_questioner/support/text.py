"""Small helpers for texts in plain English."""

from __future__ import annotations


def one_line(text: object) -> str:
    """Return a text, such as that of an error, without its line breaks and repeated blanks."""
    return ' '.join(str(text).split())


def number_of(count: int, one: str, many: str = '') -> str:
    """Return a count with its noun: `1 turn`, `2 turns`; `many` is the plural of a noun that does not take an s."""
    return f'{count} {one if count == 1 else many or one + "s"}'
