"""A limit on how often something may happen."""

from __future__ import annotations

import time


class RateLimiter:
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


class RepeatLimiter:
    """Lets each kind of thing through once in any period, and at most so many kinds; counts what it holds back.

    Args:
        most: kinds that pass within a period.
        period: seconds.
    """

    def __init__(self, most: int, period: float) -> None:
        self._most = most
        self._period = period
        self._passed: dict[str, float] = {}
        self._held_back = 0

    def passes(self, kind: str) -> bool:
        """Whether one of this kind may pass now; if so, it has."""
        now = time.monotonic()
        self._passed = {each: at for each, at in self._passed.items() if now - at < self._period}
        if kind in self._passed or len(self._passed) >= self._most:
            self._held_back += 1
            return False
        self._passed[kind] = now
        return True

    def held_back(self) -> int:
        """How many, of whatever kind, did not pass since the last time that this was asked."""
        count, self._held_back = self._held_back, 0
        return count
