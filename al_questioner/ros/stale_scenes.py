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

    def pass_over(self, stamp: int, turn: int, is_ahead: bool) -> None:
        """Take note of a scene that is older than the turn.

        Args:
            stamp: of the scene, in nanoseconds.
            turn: stamp of the turn, in nanoseconds.
            is_ahead: whether the turn's stamp is later than what our clock shows.

        Raises:
            SceneError: it has no stamp, or for a while nothing but such scenes has come, since a clock may be wrong.
        """
        if stamp == 0:
            raise SceneError('the stamp of the cloud is 0: its header must hold the time at which it was seen')
        self._count += 1
        if self._count >= FEWEST and time.monotonic() - self._began >= PATIENCE:
            lag = (turn - stamp) / SECOND
            why = 'our clock has gone back' if is_ahead else 'is the clock of their sender behind?'
            raise SceneError(f'all clouds are older than the turn, the last one by {lag:.1f} s: {why}')
