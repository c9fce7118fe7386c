"""The last look of each object: a look that stays the same is one observation, however long it stays."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from al_questioner.domain import FloatArray


class LastLooks:
    """The last look of each object, by its id, to the last bit of a float32."""

    def __init__(self) -> None:
        self._looks: dict[int, bytes] = {}

    def take(self, object_ids: Sequence[int], features: FloatArray) -> list[int]:
        """Take (n, m) raw features for the last looks, and return the rows of those that are not as they were."""
        looks = [row.tobytes() for row in features.astype(np.float32)]
        new = [row for row, each in enumerate(object_ids) if self._looks.get(each) != looks[row]]
        self._looks.update(zip(object_ids, looks, strict=True))
        return new
