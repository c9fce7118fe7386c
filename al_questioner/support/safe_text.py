"""Conversion of foreign text for a screen: control characters are shown, never executed."""

from __future__ import annotations

ELLIPSIS = '…'


LARGEST_COUNT = 1_000_000


def counted(number: int) -> str:
    """Return a number of turns as text; messages may hold numbers that are too long for a line, or for Python."""
    return str(number) if abs(number) <= LARGEST_COUNT else 'very many'


def printable(text: str, longest: int = 400) -> str:
    r"""Return the text with all characters escaped that a terminal cannot show, such as `\x1b`, and cut if long."""
    cut = text if len(text) <= longest else text[: longest - 1] + ELLIPSIS
    return ''.join(character if character.isprintable() else _escaped(character) for character in cut)


def _escaped(character: str) -> str:
    return character.encode('unicode_escape').decode('ascii') if character != ' ' else character
