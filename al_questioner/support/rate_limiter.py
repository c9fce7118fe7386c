"""Limits on how often something may happen; the caller hands in the time, in seconds of a steady clock."""

from __future__ import annotations


class RateLimiter:
    """A limiter that lets at most `most` events pass in any period of `period` seconds."""

    def __init__(self, most: int, period: float) -> None:
        self._most, self._period = most, period
        self._passed: list[float] = []

    def passes(self, now: float) -> bool:
        """Return whether one more event may pass now, and count it if so."""
        self._passed = [at for at in self._passed if now - at < self._period]
        if len(self._passed) >= self._most:
            return False
        self._passed.append(now)
        return True


class RepeatLimiter:
    """A limiter that lets each kind of event pass once in any period, and at most `most` kinds; it counts the others.

    The period is in seconds.
    """

    def __init__(self, most: int, period: float) -> None:
        self._most, self._period = most, period
        self._passed: dict[str, float] = {}
        self._held_back = 0

    def passes(self, kind: str, now: float) -> bool:
        """Return whether an event of this kind may pass now, and count it."""
        self._passed = {each: at for each, at in self._passed.items() if now - at < self._period}
        if kind in self._passed or len(self._passed) >= self._most:
            self._held_back += 1
            return False
        self._passed[kind] = now
        return True

    def held_back(self) -> int:
        """Return how many events of any kind did not pass since the last call."""
        count, self._held_back = self._held_back, 0
        return count
