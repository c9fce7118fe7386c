"""Picture in the characters of a terminal, and the part of the scene's picture that shows one object."""

from __future__ import annotations

import cv2
import numpy as np
from rich.color import Color
from rich.style import Style
from rich.text import Text

from al_questioner.domain import Scene
from al_questioner.questioning.dialogue.view_state import Picture
from al_questioner.simulation.kitchen.table_image import Projection
from al_questioner.terminal.capabilities import Capabilities

SHOWN_M = 0.08
"""Distance around an object that its picture shows, in metres."""
RAMP = ' .:-=+*#%@'
"""Characters from dark to bright."""


def thumbnail(picture: Picture, columns: int, rows: int, capabilities: Capabilities) -> list[Text]:
    """Return the picture in at most this number of columns and rows; half a character is about square.

    With colours, each character shows two; otherwise it is one of a few characters by brightness.
    """
    height, width = picture.shape[:2]
    zoom = min(columns / width, 2 * rows / height)
    columns, rows = max(1, round(width * zoom)), max(1, round(height * zoom / 2))
    if capabilities.in_color and capabilities.unicode:
        pixels = _resized(picture, columns, 2 * rows)
        return [_colored(upper, lower) for upper, lower in zip(pixels[0::2], pixels[1::2], strict=True)]
    brightness = cv2.cvtColor(_resized(picture, columns, rows), cv2.COLOR_RGB2GRAY).astype(np.float64)
    low, high = brightness.min(), brightness.max()
    steps = (brightness - low) / max(1.0, high - low) * (len(RAMP) - 1)
    return [Text(''.join(RAMP[round(step)] for step in row)) for row in steps]


def cut_out(picture: Picture, scene: Scene, object_id: int) -> Picture | None:
    """Return the part of the scene's picture that shows an object.

    None if its place is not known: the picture may be a camera's, whose projection is unknown, instead of one that
    perception draws; or the object lies outside of it.
    """
    projection = Projection(width_px=picture.shape[1])
    if object_id not in scene.object_ids or picture.shape[0] != projection.height_px:
        return None
    x, y = (float(value) for value in scene.positions[scene.index_of(object_id), :2])
    column, row = projection.pixel(x, y)
    if not (0 <= column < picture.shape[1] and 0 <= row < picture.shape[0]):
        return None
    reach = max(4, round(SHOWN_M * projection.scale))
    return picture[max(0, row - reach) : row + reach, max(0, column - reach) : column + reach]


def _resized(picture: Picture, width: int, height: int) -> Picture:
    resized = cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)
    return resized.astype(np.uint8)


def _colored(upper: Picture, lower: Picture) -> Text:
    line = Text()
    for top, bottom in zip(upper.tolist(), lower.tolist(), strict=True):
        line.append('▀', Style(color=Color.from_rgb(*top), bgcolor=Color.from_rgb(*bottom)))
    return line
