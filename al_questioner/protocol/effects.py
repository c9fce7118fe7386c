"""Effects that a machine has done for it, one after the other."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any


class Level(Enum):
    """Seriousness of a line of the node's log."""

    INFO = 'info'
    WARNING = 'warning'
    ERROR = 'error'


@dataclass(frozen=True)
class Publish:
    """A message on a topic; its content is what `topics` says of the topic."""

    topic: str
    content: Any


@dataclass(frozen=True)
class SetTimer:
    """A timer that rings once, these seconds of the steady clock after the effect; it replaces one of its name."""

    timer: str
    seconds: float


@dataclass(frozen=True)
class ClearTimer:
    """A timer that is not to ring any more, if it is set."""

    timer: str


@dataclass(frozen=True)
class Refuse:
    """Input that cannot be used: counted, logged, shown on /diagnostics."""

    topic: str
    reason: str


@dataclass(frozen=True)
class Report:
    """Activity of the node in a few words, for /diagnostics.

    Attributes:
        expected_within: seconds after which /diagnostics warns that it lasts too long.
        awaited: topic that it waits for; if nobody publishes it, /diagnostics warns soon.
    """

    activity: str
    expected_within: float = math.inf
    awaited: str = ''


@dataclass(frozen=True)
class Say:
    """A line in the node's log."""

    text: str
    level: Level = Level.INFO


@dataclass(frozen=True)
class WriteFile:
    """A file, written as a whole or not at all; an InputError comes back if it cannot be."""

    path: Path
    text: str


@dataclass(frozen=True)
class Record:
    """A message written into the bag; an OSError comes back if it cannot be.

    Attributes:
        topic: relative name of the topic.
        data: the message as it came.
        stamp: when it came, in nanoseconds since the epoch.
    """

    topic: str
    data: bytes
    stamp: int


@dataclass(frozen=True)
class SyncBag:
    """The recorded messages, brought to the disk; an OSError comes back if it cannot be."""


@dataclass(frozen=True)
class CloseBag:
    """The bag, finished; an OSError comes back if it cannot be."""


@dataclass(frozen=True)
class AwaitArrival:
    """All that was published, arrived at those who listen, unless they are behind for longer than these seconds."""

    seconds: float


@dataclass(frozen=True)
class End:
    """The end of the process."""


Effect = (
    Publish
    | SetTimer
    | ClearTimer
    | Refuse
    | Report
    | Say
    | WriteFile
    | Record
    | SyncBag
    | CloseBag
    | AwaitArrival
    | End
)

Effects = Generator[Effect, None, None]
"""Effects in their order; each is done before the next is asked for, and its error is thrown back where it arose."""
