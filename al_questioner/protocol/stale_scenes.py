"""Check for scenes that are older than the turn, which after a while mean that a clock is wrong."""

from __future__ import annotations

from al_questioner.domain import SceneError
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.events import Now

PATIENCE = 3.0
"""Seconds in which scenes from before a turn may still arrive, because a camera's pipeline is slow."""
FEWEST = 3
"""Smallest number of such scenes in a row that is not chance."""


class StaleScenes:
    """Counter of the scenes from before the present turn. It begins with the first turn."""

    def __init__(self) -> None:
        self.begin_turn(0.0)

    def begin_turn(self, steady: float) -> None:
        """Reset the count for a turn that begins at a time of the steady clock, in seconds."""
        self._count = 0
        self._began = steady

    def pass_over(self, stamp: int, turn: int, now: Now) -> None:
        """Count a scene that is older than the turn.

        Args:
            stamp: stamp of the scene, in nanoseconds.
            turn: stamp of the turn, in nanoseconds.
            now: our time.

        Raises:
            SceneError: it has no stamp, or for a while only such scenes have come, since a clock may be wrong.
        """
        if stamp == 0:
            raise SceneError('the stamp of the cloud is 0: its header must hold the time at which it was seen')
        self._count += 1
        if self._count >= FEWEST and now.steady - self._began >= PATIENCE:
            found = 'all clouds are older than the turn'
            if turn > now.clock:
                raise SceneError(f'{found}, the last one by {(turn - stamp) / SECOND:.1f} s: our clock has gone back')
            # Compared with our clock, because the distance to the turn grows with every cloud.
            lag = f'the stamp of the last one is {(now.clock - stamp) / SECOND:.1f} s ago'
            raise SceneError(f'{found}, {lag}: is the clock of their sender behind?')
