"""A table whose things come, go and look different, and what each of them really is."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np

from al_questioner.domain import NO_SYMBOL, Scene, random_stream

SYMBOLS = ('snack', 'fruit')
FEATURES = ('colour_red', 'colour_green', 'size_height', 'size_width')
SENTINEL = -999.0
"""Reading of a sensor that read nothing."""
OTHER_IDS = 10_000
"""Difference of the ids of a thing, where a camera gives it another one for a moment."""


class Table:
    """Scenes by their number, from 0; some things stay from one to the next, some of these with another look.

    Args:
        seed: of the table.
        things: in each scene.
        noise: of a camera, in the unit of the features, whose spread is about 1.

    Attributes:
        has_misread: whether a sensor has ever read nothing.
    """

    def __init__(self, seed: int, things: int, noise: float = 0.0) -> None:
        self.things, self.noise = things, noise
        self.has_misread = False
        self._seed = seed
        self._looks: dict[int, list[np.ndarray]] = {}
        self.scene = cache(self._make)

    @property
    def repeats_exactly(self) -> bool:
        """True if each thing has looked exactly the same each time, unless it has really changed."""
        return self.noise == 0 and not self.has_misread

    def truth(self, number: int) -> Mapping[int, str]:
        """Return symbol, or none, by object id."""
        return {i: self.symbol(i) for i in self.scene(number).object_ids}

    def symbol(self, object_id: int) -> str:
        kind = int(random_stream(self._seed, f'kind {object_id % OTHER_IDS}').integers(len(SYMBOLS) + 1))
        return (*SYMBOLS, NO_SYMBOL)[kind]

    def look(self, object_id: int, features: np.ndarray) -> int:
        """Return which look of a thing a reading shows."""
        looks = self._looks[object_id % OTHER_IDS]
        return int(np.argmin([np.abs(look - features).sum() for look in looks]))

    def seen(self, number: int, glance: int) -> Scene:
        """Return a scene as a camera sees it, each time with other noise."""
        scene = self.scene(number)
        rng = random_stream(self._seed, f'noise {glance}')
        features = scene.features + rng.normal(scale=self.noise, size=scene.features.shape).astype(np.float32)
        return Scene(scene.object_ids, scene.positions, features.astype(np.float32), scene.feature_names)

    def _make(self, number: int) -> Scene:
        rng = random_stream(self._seed, f'scene {number}')
        before = [] if number == 0 else [i for i in self.scene(number - 1).object_ids if rng.random() < 0.5]
        ids = [*before, *(100 * number + i for i in range(self.things - len(before)))]
        rows = []
        for object_id in ids:
            looks = self._looks.setdefault(object_id, [])
            if not looks or rng.random() < 0.3:
                middle = 2.0 * np.eye(4)[(*SYMBOLS, NO_SYMBOL).index(self.symbol(object_id))]
                looks.append((middle + rng.normal(size=4)).astype(np.float32))
            rows.append(looks[-1])
        positions = rng.normal(size=(len(ids), 3)).astype(np.float32)
        return Scene(tuple(ids), positions, np.array(rows, dtype=np.float32), FEATURES)
