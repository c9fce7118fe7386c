"""A clock that only a test moves, and what it has do jobs later."""

from __future__ import annotations

from collections.abc import Callable
from itertools import count


class VirtualTime:
    """Stands for a node's worker and its clock."""

    def __init__(self) -> None:
        self.now = 0.0
        self._entries: list[tuple[float, int, Callable[[], None]]] = []
        self._numbers = count()

    @property
    def waiting(self) -> int:
        """Number of jobs that are still to be done."""
        return len(self._entries)

    def after(self, seconds: float, job: Callable[[], None]) -> Callable[[], None]:
        """Do a job later; return what calls it off."""
        entry = (self.now + seconds, next(self._numbers), job)
        self._entries.append(entry)
        return lambda: self._entries.remove(entry) if entry in self._entries else None

    def pass_until(self, end: float) -> None:
        """Let time pass, and do what is due."""
        self._entries.sort()
        while self._entries and self._entries[0][0] <= end:
            self.now, _, job = self._entries.pop(0)
            job()
            self._entries.sort()
        self.now = end
