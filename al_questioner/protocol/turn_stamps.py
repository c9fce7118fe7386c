"""Stamps of turns, and a test which scenes belong to a turn, on a clock that may jump."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable

from al_questioner.messages.stamps import SECOND

LATEST = (2**31 - 1) * SECOND
"""Latest stamp, in nanoseconds; a later time is rejected, since it leaves no room for the following stamps."""
STAMPS_KEPT = 1000
"""Number of latest stamps that are known again after the clock has gone back: a session must not fill the memory."""


class TurnStamps:
    """Generator of turn stamps, each later than all before, whatever the clock does.

    A scene belongs to the present turn if it is not older than the turn's stamp: perception may copy the stamp, a
    camera has its own time. After the clock has gone back (a bag that loops, a simulation that is started again) stamps
    are ahead of it. Then scenes count, too, that were taken since the turn began, or since the clock went back if that
    was later, by the present clock. A scene from before the clock went back is later than that clock, and does not
    count. All times are nanoseconds.

    Args:
        earlier: stamps of the turns before these, in their order.

    Attributes:
        last: stamp of the present turn.
    """

    def __init__(self, earlier: Iterable[int] = ()) -> None:
        self._given = deque([0, *earlier], maxlen=STAMPS_KEPT)
        self.last = self._given[-1]
        self._since = self.last

    def begin(self, now: int) -> int:
        """Return the stamp of a new turn."""
        self._since = now
        self.last = now if self.last < now <= LATEST else self.last + 1
        self._given.append(self.last)
        return self.last

    def is_of_turn(self, stamp: int, now: int) -> bool:
        """Return whether a scene belongs to the present turn."""
        # A step back of the clock is noticed at the next scene; until then no scene can be missed.
        self._since = min(self._since, now)
        return stamp >= self.last or (self._since <= stamp <= now and stamp not in self._given)
