"""Places on the table: a grid of cells, so that objects never overlap."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from al_questioner.simulation.task_reading import Interval


class Place(NamedTuple):
    """Place of one object.

    Attributes:
        x, y: metres in the table's frame, the middle of a cell.
        slack: largest distance of the object from the middle, in metres along each axis.
    """

    x: float
    y: float
    slack: float


@lru_cache(maxsize=32)
def places(table_m: Interval, count: int) -> tuple[Place, ...]:
    """Return `count` places, row by row, every other row shifted by half a cell."""
    width, depth = table_m
    rows = max(1, round(float(np.sqrt(count * depth / width))))
    columns = -(-count // rows)
    across, along = width / (columns + 0.5 * (rows > 1)), depth / rows
    slack = 0.15 * min(across, along)
    spots = []
    for i in range(count):
        row, column = divmod(i, columns)
        shift = 0.5 * across if row % 2 else 0.0
        spots.append(Place((column + 0.5) * across + shift, (row + 0.5) * along, slack))
    return tuple(spots)
