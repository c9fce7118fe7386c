"""Machine of perception in a simulated world."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Observation, Scene
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.effects import Effects, Publish, Report
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import PictureToDraw, SceneShown
from al_questioner.protocol.worlds import check_world


class SeenWorld(Protocol):
    """A world that can be looked at, turn by turn."""

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn; the same object as long as nothing changes."""
        ...

    def observations(self, turn: int) -> Sequence[Observation]:
        """Return what the scene of a turn was perceived from."""
        ...


class PerceptionMachine(Machine):
    """Answers every `turn` with the `objects` of that turn, under the turn's stamp, and tells of each new picture.

    Args:
        seen: the world that is looked at.
        world: the same world, as documents have it.
        frame_id: of the positions.
        draw: makes an (h, w, 3) picture for people of what is observed.
    """

    publishes = ('objects', 'scene_image')

    def __init__(
        self,
        seen: SeenWorld,
        world: Document,
        frame_id: str,
        draw: Callable[[Sequence[Observation]], NDArray[np.uint8]],
    ) -> None:
        super().__init__()
        self._seen = seen
        self._world = world
        self._frame_id = frame_id
        self._draw = draw
        self._pictured: Scene | None = None
        self.on_document('turn', self._look)

    def start(self) -> Effects:
        """Say what it waits for."""
        yield Report('waiting for a turn', awaited='turn')

    def _look(self, document: Document) -> Effects:
        check_world(document, self._world)
        turn, stamp = document['turn'], stamp_of(document['stamp'])
        scene = self._seen.scene(turn)
        yield Publish('objects', SceneShown(scene, stamp, self._frame_id))
        yield Report(f'turn {turn}: {len(scene)} objects')
        if scene is not self._pictured:
            self._pictured = scene
            draw = partial(self._draw, self._seen.observations(turn))
            yield Publish('scene_image', PictureToDraw(draw, stamp, self._frame_id))
