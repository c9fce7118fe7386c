"""All distinct views that were seen, with a label or without: the pool of pool-based active learning."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray

Compare = Callable[[FloatArray, FloatArray], NDArray[np.bool_]]
"""Function that returns (k,) booleans: whether each of (k, m) raw features shows the same view as (m,) others."""


class SeenViews:
    """Distinct views of all objects, in the order in which they were seen first."""

    def __init__(self) -> None:
        self._object_ids: list[int] = []
        self._views: list[NDArray[np.float32]] = []
        self._rows_of: dict[int, list[int]] = {}
        self._latest: dict[int, int] = {}

    def __len__(self) -> int:
        return len(self._views)

    @property
    def object_ids(self) -> tuple[int, ...]:
        """Object that each view shows."""
        return tuple(self._object_ids)

    @property
    def features(self) -> NDArray[np.float32]:
        """Raw features, (n, m); (0, 0) before the first view."""
        return np.array(self._views, dtype=np.float32).reshape(len(self), -1 if self._views else 0)

    def add(self, object_id: int, view: FloatArray, are_same: Compare) -> None:
        """Add a view of an object, (m,) raw features, unless it is known; from now on it is the object's latest."""
        rows = self._rows_of.setdefault(object_id, [])
        if rows:
            is_same = are_same(np.array([self._views[row] for row in rows]), view)
            if is_same.any():
                self._latest[object_id] = rows[int(np.argmax(is_same))]
                return
        self._latest[object_id] = len(self)
        rows.append(len(self))
        self._object_ids.append(object_id)
        self._views.append(np.array(view, dtype=np.float32))

    def of_object(self, object_id: int) -> NDArray[np.float32]:
        """Return the raw features, (k, m), of the views of an object; (0, 0) if it was never seen."""
        rows = self._rows_of.get(object_id, [])
        return np.array([self._views[row] for row in rows], dtype=np.float32).reshape(len(rows), -1 if rows else 0)

    def latest_rows(self, object_ids: Iterable[int]) -> NDArray[np.intp]:
        """Return the row of the latest view of each object.

        Raises:
            KeyError: an object that was never seen.
        """
        return np.array([self._latest[object_id] for object_id in object_ids], dtype=np.intp)
