"""A limit on how often something may happen."""

from __future__ import annotations

import time


class Throttle:
    """Lets at most so many through in any period, by the steady clock.

    Args:
        most: that pass within a period.
        period: seconds.
    """

    def __init__(self, most: int, period: float) -> None:
        self._most = most
        self._period = period
        self._passed: list[float] = []

    @property
    def is_used_up(self) -> bool:
        """Whether no more may pass for now."""
        now = time.monotonic()
        self._passed = [at for at in self._passed if now - at < self._period]
        return len(self._passed) >= self._most

    def passes(self) -> bool:
        """Whether one more may pass now; if so, it has."""
        if self.is_used_up:
            return False
        self._passed.append(time.monotonic())
        return True
