"""Stamps of turns, and which scenes are of a turn, on a clock that may jump."""

from __future__ import annotations

from al_questioner.messages.stamps import SECOND

LATEST = (2**31 - 1) * SECOND
"""Nanoseconds; a clock that shows a later time leaves no room for the stamps after it, and is not believed."""


class TurnStamps:
    """Gives every turn a later stamp than any before, whatever the clock does.

    A scene is of the present turn if it is not older than the turn's stamp: perception may copy the stamp, a camera has
    its own time. After the clock has gone back (a bag that loops, a simulation that is started again) stamps run ahead
    of it. Then scenes count, too, that were taken since the turn began, or since the clock went back if that was later,
    by the clock as it is now; what was taken before it went back is later than that clock, and does not.

    All times are nanoseconds.

    Args:
        last: stamp of a turn that was before all of these.

    Attributes:
        last: stamp of the present turn.
    """

    def __init__(self, last: int = 0) -> None:
        self.last = last
        self._since = last
        self._given = {last}

    def begin(self, now: int) -> int:
        """The stamp of a new turn.

        Args:
            now: what the clock shows.
        """
        self._since = now
        self.last = now if self.last < now <= LATEST else self.last + 1
        self._given.add(self.last)
        return self.last

    def is_of_turn(self, stamp: int, now: int) -> bool:
        """Whether a scene is of the present turn.

        Args:
            stamp: of the scene.
            now: what the clock shows.
        """
        # That the clock went back is noticed when the next scene comes; before, none could be missed.
        self._since = min(self._since, now)
        return stamp >= self.last or (self._since <= stamp <= now and stamp not in self._given)
