"""Meaning of a line that a person typed."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum

from al_questioner.domain.names import meant


class Wish(Enum):
    """A request to this program, not an answer to the robot."""

    UNDO = 'undo'
    HELP = 'help'
    QUIT = 'quit'


@dataclass(frozen=True)
class Say:
    """An answer to the robot, in the words of `read_plain_answer`."""

    text: str


@dataclass(frozen=True)
class Explain:
    """An explanation why the typed text means nothing."""

    text: str


Command = Say | Wish | Explain

WISHES = {wish.value: wish for wish in Wish}
"""Requests by their word; none of these words can be an answer on a line of its own."""


def read_line(line: str, choices: Collection[str] = ()) -> Command:
    """Return the meaning of a line; a blank line is not an answer, and gets an explanation.

    A line that is exactly one of the choices of the open question is an answer.
    """
    word = line.strip()
    if not word:
        return Explain('an empty line is no answer')
    if word in choices:
        return Say(word)
    found = meant(word, WISHES)
    return WISHES[found[0]] if found else Say(word)
