"""When scenes that are older than the turn are a concern, and not only what was under way as it began."""

from __future__ import annotations

import time

from al_questioner.domain import SceneError
from al_questioner.messages.stamps import SECOND

PATIENCE = 3.0
"""Seconds in which scenes from before a turn may still arrive: a camera's pipeline takes its time."""
FEWEST = 3
"""So many of them in a row are no chance any more."""


class StaleScenes:
    """Counts the scenes from before the present turn. It begins with the first turn."""

    def __init__(self) -> None:
        self.begin_turn()

    def begin_turn(self) -> None:
        """Forget those of the turn before."""
        self._count = 0
        self._began = time.monotonic()

    def pass_over(self, stamp: int, turn: int, now: int) -> None:
        """Take note of a scene that is older than the turn.

        Args:
            stamp: of the scene, in nanoseconds.
            turn: stamp of the turn, in nanoseconds.
            now: what our clock shows, in nanoseconds.

        Raises:
            SceneError: it has no stamp, or for a while nothing but such scenes has come, since a clock may be wrong.
        """
        if stamp == 0:
            raise SceneError('the stamp of the cloud is 0: its header must hold the time at which it was seen')
        self._count += 1
        if self._count >= FEWEST and time.monotonic() - self._began >= PATIENCE:
            found = 'all clouds are older than the turn'
            if turn > now:
                raise SceneError(f'{found}, the last one by {(turn - stamp) / SECOND:.1f} s: our clock has gone back')
            # Against our clock, as the turn began longer ago with every cloud.
            lag = f'the stamp of the last one is {(now - stamp) / SECOND:.1f} s ago'
            raise SceneError(f'{found}, {lag}: is the clock of their sender behind?')
