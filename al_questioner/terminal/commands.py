"""What a line that a person typed asks for."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from enum import Enum

from al_questioner.domain.names import meant


class Wish(Enum):
    """What is asked of this program, rather than said to the robot."""

    UNDO = 'undo'
    HELP = 'help'
    QUIT = 'quit'


@dataclass(frozen=True)
class Say:
    """Something that is said to the robot, in the words of `read_plain_answer`."""

    text: str


@dataclass(frozen=True)
class Explain:
    """Why what was typed means nothing."""

    text: str


Command = Say | Wish | Explain

WISHES = {
    'undo': Wish.UNDO,
    'help': Wish.HELP,
    'quit': Wish.QUIT,
}
"""By the word; none of them can be told to the robot on a line of its own."""


def read_line(line: str, choices: Collection[str] = ()) -> Command:
    """What a line means; a blank one is explained, as an answer has to be meant.

    Args:
        line: that was typed.
        choices: of the question that is open: what is exactly one of them is an answer.
    """
    word = line.strip()
    if not word:
        return Explain('an empty line is no answer')
    if word in choices:
        return Say(word)
    found = meant(word, WISHES)
    return WISHES[found[0]] if found else Say(word)
