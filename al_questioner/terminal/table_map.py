"""Map of the table in characters: the number of every object at its place."""

from __future__ import annotations

from collections.abc import Collection
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from rich.text import Text

from al_questioner.domain import Scene

FOCUS_STYLE = 'not dim bold reverse'


def table_map(
    scene: Scene, columns: int, rows: int, focus: int | None, marked: Collection[int] = frozenset()
) -> list[Text]:
    """Return as many rows of text, which show the scene from above, its far side up; the frame counts.

    Objects that are closer together than the width of their numbers are shown beside each other. Objects without a
    place are counted in the last row. The object in focus is in brackets, and like the marked ones in reverse video.
    There must be 12 columns and 3 rows at least.
    """
    places, left_out = _placed(scene, columns - 2, rows - 2, focus)
    lines = [Text('┌' + '─' * (columns - 2) + '┐', style='dim')]
    for row in range(rows - 2):
        line = Text('│', style='dim')
        at = 0
        for column, object_id in sorted(places.get(row, ())):
            label = _label(object_id, focus)
            line.append(' ' * (column - at))
            line.append(label, style=FOCUS_STYLE if object_id == focus or object_id in marked else 'not dim')
            at = column + len(label)
        line.append(' ' * (columns - 2 - at) + '│')
        lines.append(line)
    note = f' and {left_out} more ' if left_out else ''
    note = note if len(note) <= columns - 2 else ''
    lines.append(Text('└' + note + '─' * (columns - 2 - len(note)) + '┘', style='dim'))
    return lines


def position_in_words(scene: Scene, object_id: int) -> str:
    """Return the position of an object on the table in words, for a person in front of it."""
    x, y = (float(value) for value in scene.positions[scene.index_of(object_id), :2])
    across, along = _shares(scene)[scene.index_of(object_id)]
    side = ('left', 'middle', 'right')[min(2, int(3 * across))]
    depth = ('front', 'middle', 'back')[min(2, int(3 * along))]
    words = 'in the middle' if side == depth == 'middle' else f'{depth} {side}' if depth != 'middle' else f'{side}'
    return f'{words}, at x {x:.2f} m, y {y:.2f} m'


def _label(object_id: int, focus: int | None) -> str:
    return f'[{object_id}]' if object_id == focus else str(object_id)


def _shares(scene: Scene) -> NDArray[np.float64]:
    """Return (n, 2) position of each object between the outermost ones, in [0, 1]; one half if all lie on a line."""
    plane = scene.positions[:, :2].astype(np.float64)
    if not len(scene):
        return plane
    low, extent = plane.min(axis=0), np.ptp(plane, axis=0)
    return np.where(extent > 0, (plane - low) / np.where(extent > 0, extent, 1.0), 0.5)


@lru_cache(maxsize=64)
def _placed(
    scene: Scene, columns: int, rows: int, focus: int | None
) -> tuple[dict[int, tuple[tuple[int, int], ...]], int]:
    """Return (column, id) of the objects by row, and the number without a place; the focus is placed first."""
    shares = _shares(scene)
    order = sorted(range(len(scene)), key=lambda i: (scene.object_ids[i] != focus, scene.object_ids[i]))
    taken = np.zeros((rows, columns), dtype=bool)
    places: dict[int, list[tuple[int, int]]] = {}
    for n_placed, i in enumerate(order):
        width = len(_label(scene.object_ids[i], focus))
        row = round(float((1 - shares[i, 1]) * (rows - 1)))
        column = round(float(shares[i, 0] * (columns - width)))
        found = _nearest_gap(taken, row, column, width)
        if found is None:
            return {key: tuple(value) for key, value in places.items()}, len(order) - n_placed
        row, column = found
        # With a blank on either side, so that two numbers never look like one.
        taken[row, max(0, column - 1) : column + width + 1] = True
        places.setdefault(row, []).append((column, scene.object_ids[i]))
    return {key: tuple(value) for key, value in places.items()}, 0


def _nearest_gap(taken: NDArray[np.bool_], row: int, column: int, width: int) -> tuple[int, int] | None:
    """Return the (row, column) next to the wanted one where `width` cells are free in a row."""
    if taken.shape[1] < width:
        return None
    if not taken[row, column : column + width].any():
        return row, column
    windows = np.lib.stride_tricks.sliding_window_view(taken, width, axis=1)
    free = np.argwhere(~windows.any(axis=2))
    if len(free) == 0:
        return None
    # A character is about twice as high as it is wide.
    best = free[np.hypot(2 * (free[:, 0] - row), free[:, 1] - column).argmin()]
    return int(best[0]), int(best[1])
