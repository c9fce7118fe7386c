"""Text from elsewhere, made fit for a terminal: what it holds is shown, and never obeyed."""

from __future__ import annotations

ELLIPSIS = '…'


LARGEST_COUNT = 1_000_000


def counted(number: int) -> str:
    """A number of turns; messages may tell of more than a line can hold, or than Python will write."""
    return str(number) if abs(number) <= LARGEST_COUNT else 'very many'


def printable(text: str, longest: int = 400) -> str:
    r"""The text with all that a terminal would not show as a character escaped, such as `\x1b`, and cut if long."""
    cut = text if len(text) <= longest else text[: longest - 1] + ELLIPSIS
    return ''.join(character if character.isprintable() else _escaped(character) for character in cut)


def _escaped(character: str) -> str:
    return character.encode('unicode_escape').decode('ascii') if character != ' ' else character
