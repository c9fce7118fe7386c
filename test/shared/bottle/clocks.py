"""A robot's clock, which may jump, drift and stand still."""

from __future__ import annotations

from shared.bottle.faults import Faults
from shared.bottle.scheduler import Scheduler

BEGINNING = 1_000_000_000_000
"""Nanoseconds that every clock shows at the beginning."""
JUMPS_S = (-3600.0, -30.0, -2.0, -0.1, 0.5, 20.0, 3600.0)
DRIFTS = (-1e-2, 1e-3, 1e-2)
SECONDS_BETWEEN = 5.0


class RobotClock:
    """A clock that is right as long as no fault happens to it.

    Args:
        owner: who reads it, for the names of its faults.
    """

    def __init__(self, owner: str, scheduler: Scheduler, faults: Faults) -> None:
        self._owner, self._scheduler, self._faults = owner, scheduler, faults
        self._offset = self._rate = 0.0
        self._since = 0.0
        self._stands_at: float | None = None
        self._number = 0
        scheduler.after(SECONDS_BETWEEN, self._change)

    @property
    def nanoseconds(self) -> int:
        return BEGINNING + int(self._seconds() * 1e9)

    def set_right(self) -> None:
        """Show the true time again, as once a time server is heard."""
        self._offset = self._rate = 0.0
        self._stands_at = None

    def _seconds(self) -> float:
        if self._stands_at is not None:
            return self._stands_at
        now = self._scheduler.now
        return now + self._offset + self._rate * (now - self._since)

    def _change(self) -> None:
        if not self._faults.active:
            return
        number, draw = self._number, self._faults.draw
        self._number += 1
        shown = self._seconds()
        if self._faults.happens('clock jumps', self._owner, number):
            shown += JUMPS_S[int(draw('jump', self._owner, number) * len(JUMPS_S))]
        if self._faults.happens('clock drifts', self._owner, number):
            self._rate = DRIFTS[int(draw('drift', self._owner, number) * len(DRIFTS))]
        stands = self._faults.happens('clock stands', self._owner, number)
        self._since, self._offset = self._scheduler.now, shown - self._scheduler.now
        self._stands_at = shown if stands else None
        self._scheduler.after(SECONDS_BETWEEN, self._change)
