"""Events that a machine is told of, and the time at which they happen."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol


@dataclass(frozen=True)
class Started:
    """The process has begun: the first event of every machine."""


@dataclass(frozen=True)
class Heard:
    """A message of a topic.

    Attributes:
        topic: its name, relative to the namespace of the robot.
        content: a text for topics of texts, otherwise what `topics` says.
    """

    topic: str
    content: Any


@dataclass(frozen=True)
class TimerFired:
    """A timer that the machine has set."""

    timer: str


@dataclass(frozen=True)
class Entered:
    """An act of a person at this process.

    Attributes:
        source: name of what they did it with, or of what they did.
        content: what the machine says of the source.
    """

    source: str
    content: Any


Event = Started | Heard | TimerFired | Entered


class Now(Protocol):
    """The time, each time it is read."""

    @property
    def steady(self) -> float:
        """Seconds of a clock that never jumps."""
        ...

    @property
    def clock(self) -> int:
        """Nanoseconds of the clock of the robot, real or simulated, which may jump."""
        ...


@dataclass(frozen=True)
class Moment:
    """A time that stands still while an event is handled."""

    steady: float = 0.0
    clock: int = 0
