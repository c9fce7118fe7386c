"""Picture of the table for people: the views of a scene at the places of their objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray, Observation, View
from al_questioner.simulation.kitchen.drawing.images import blurred, resized
from al_questioner.simulation.kitchen.drawing.texture import TABLE_TILE_M, table_top

RGB = tuple[int, int, int]
Extent = tuple[int, int, int, int]
Pixel = tuple[int, int]

TABLE_M = (1.4, 0.8)
WIDTH_PX = 1280
RIM_M = 0.14
"""Width of the visible ground left and right of the table, in metres."""
SQUASH = 0.82
"""Height of a square metre of the table relative to its width; the picture is taken from above and in front."""

FONT = cv2.FONT_HERSHEY_SIMPLEX
TEXT_SCALE = 0.46
"""Scale of all texts, in a picture of full width."""

LEADER_PX = 20
"""Distance from a number to its object, in pixels of a picture of full width, above which a line connects them."""


@dataclass(frozen=True)
class Mark:
    """Mark of an object: a ring around it, and a text under it, or, if numbers are there, elsewhere beside it.

    Attributes:
        color: red, green, blue in 0..255.
        label: short; may be empty.
    """

    color: RGB
    label: str = ''


@dataclass(frozen=True, eq=False)
class TablePicture:
    """A drawn scene.

    Attributes:
        image: (h, w, 3) uint8, red-green-blue.
        pixels: (column, row) of the middle of each object, by id.
    """

    image: NDArray[np.uint8]
    pixels: Mapping[int, tuple[int, int]] = field(default_factory=dict)


@dataclass(frozen=True)
class Projection:
    """Mapping of positions on the table to its picture.

    Attributes:
        table_m: width and depth of the table.
        width_px: width of the picture.
    """

    table_m: tuple[float, float] = TABLE_M
    width_px: int = WIDTH_PX

    @property
    def scale(self) -> float:
        """Pixels per metre, along a row."""
        return self.width_px / (self.table_m[0] + 2 * RIM_M)

    @property
    def height_px(self) -> int:
        """Height of the picture."""
        return int((self.table_m[1] + 2.2 * RIM_M) * self.scale * SQUASH)

    def pixel(self, x: float, y: float) -> tuple[int, int]:
        """Return the (column, row) of a point of the table, in metres; it may lie outside the picture."""
        column = int((x + RIM_M) * self.scale)
        return column, int(self.height_px - (y + 0.9 * RIM_M) * self.scale * SQUASH)


def draw_scene(
    observations: Sequence[Observation],
    marks: Mapping[int, Mark] | None = None,
    *,
    table_m: tuple[float, float] = TABLE_M,
    width_px: int = WIDTH_PX,
) -> TablePicture:
    """Draw the table from above and in front, with each object from its own view and its id beside it.

    The marks are by id. Works with any views, simulated or real: each is cut out by its mask and scaled by its depth.
    """
    projection = Projection(table_m, width_px)
    image = _backdrop(projection.height_px, width_px, projection.scale, SQUASH)
    order = sorted(observations, key=lambda o: -o.position[1])
    pixels = {o.object_id: projection.pixel(o.position[0], o.position[1]) for o in order}
    pasted = {o.object_id: _paste(image, o.view, pixels[o.object_id], projection.scale) for o in order}
    extents = {object_id: extent for object_id, (extent, _) in pasted.items()}
    canvas = np.clip(image, 0, 255).astype(np.uint8)
    zoom = width_px / 1280
    marked = {o.object_id: mark for o in order if (mark := (marks or {}).get(o.object_id)) is not None}
    # Plates come last, and those of the answers after all others, so that nothing hides them.
    for object_id, mark in marked.items():
        _ring(canvas, extents[object_id], mark, zoom)
    for extent, nearest in pasted.values():
        _leader(canvas, extent, nearest, zoom)
    taken = [_number(canvas, o.object_id, extents[o.object_id], marked.get(o.object_id), zoom) for o in order]
    for object_id, mark in marked.items():
        if mark.label:
            taken.append(_label(canvas, extents[object_id], mark, taken, zoom))
    return TablePicture(canvas, pixels)


def _backdrop(height: int, width: int, scale: float, squash: float) -> FloatArray:
    tile = table_top(0)
    need_rows, need_columns = int(height / scale / squash / TABLE_TILE_M) + 1, int(width / scale / TABLE_TILE_M) + 1
    repeats = -(-need_rows // tile.shape[0]), -(-need_columns // tile.shape[1]), 1
    patch = np.tile(tile, repeats)[:need_rows, :need_columns]
    picture = resized(patch, (width, height), cv2.INTER_CUBIC) * 255
    rows, columns = np.linspace(-1, 1, height)[:, None], np.linspace(-1, 1, width)[None, :]
    light = 1.04 - 0.16 * (0.7 * columns**2 + 0.5 * (rows - 0.3) ** 2)
    return picture * light[..., None].astype(np.float32)


def _paste(image: FloatArray, view: View, middle: Pixel, scale: float) -> tuple[Extent, Pixel]:
    """Paste a view on the table, middle on middle, with a soft shadow.

    Returns:
        Left, top, right, bottom of the object, and its point that is nearest to the top left of these.
    """
    rows, columns = np.flatnonzero(view.mask.any(axis=1)), np.flatnonzero(view.mask.any(axis=0))
    if len(rows) == 0:
        return (*middle, *middle), middle
    readings = view.depth[view.mask & (view.depth > 0)]
    distance = float(np.median(readings)) / 1000 if len(readings) else 1.0
    zoom = scale * distance / view.camera.fx
    pad = 2
    top, left = max(rows[0] - pad, 0), max(columns[0] - pad, 0)
    crop = np.s_[top : rows[-1] + 1 + pad, left : columns[-1] + 1 + pad]
    shape = max(2, round((crop[1].stop - left) * zoom)), max(2, round((crop[0].stop - top) * zoom))
    color = resized(np.ascontiguousarray(view.color[crop][..., ::-1]), shape, cv2.INTER_CUBIC)
    alpha = resized(view.mask[crop].astype(np.float32), shape)
    alpha = np.clip((blurred(alpha, 0.8) - 0.3) / 0.5, 0, 1)

    h, w = alpha.shape
    x, y = middle[0] - w // 2, middle[1] - h // 2
    _darken(image, alpha, x + max(2, w // 14), y + max(2, h // 14))
    _blend(image, color.astype(np.float32), alpha, x, y)
    inside = np.argwhere(alpha > 0.5)
    row, column = inside[(inside**2).sum(axis=1).argmin()] if len(inside) else (h // 2, w // 2)
    return (x, y, x + w, y + h), (x + int(column), y + int(row))


def _darken(image: FloatArray, alpha: FloatArray, x: int, y: int) -> None:
    soft = 10
    shadow = blurred(np.pad(alpha, soft), 4.5)
    window, part = _overlap(image, shadow, x - soft, y - soft)
    window *= 1 - 0.45 * part[..., None]


def _blend(image: FloatArray, color: FloatArray, alpha: FloatArray, x: int, y: int) -> None:
    window, part = _overlap(image, np.dstack([color, alpha]), x, y)
    share = part[..., 3:]
    window += share * (part[..., :3] - window)


def _overlap(image: FloatArray, patch: FloatArray, x: int, y: int) -> tuple[FloatArray, FloatArray]:
    """Return the part of the image that a patch at (x, y) covers, and the part of the patch inside the image."""
    h, w = patch.shape[:2]
    top, left = max(y, 0), max(x, 0)
    bottom, right = max(top, min(y + h, image.shape[0])), max(left, min(x + w, image.shape[1]))
    return image[top:bottom, left:right], patch[top - y : bottom - y, left - x : right - x]


def _ring(canvas: NDArray[np.uint8], extent: Extent, mark: Mark, zoom: float) -> None:
    left, top, right, bottom = extent
    axes = int(0.56 * (right - left)) + 8, int(0.56 * (bottom - top)) + 8
    center = (left + right) // 2, (top + bottom) // 2
    cv2.ellipse(canvas, center, axes, 0, 0, 360, (255, 255, 255), round(6 * zoom), cv2.LINE_AA)
    cv2.ellipse(canvas, center, axes, 0, 0, 360, mark.color, max(1, round(3.5 * zoom)), cv2.LINE_AA)


def _number(canvas: NDArray[np.uint8], object_id: int, extent: Extent, mark: Mark | None, zoom: float) -> Extent:
    color = (250, 250, 250) if mark is None else mark.color
    ink = (30, 30, 30) if mark is None else (255, 255, 255)
    return _tag(canvas, str(object_id), _number_at(extent, zoom), color, ink, TEXT_SCALE * zoom)


def _number_at(extent: Extent, zoom: float) -> Pixel:
    return extent[0] + round(4 * zoom), extent[1] + round(6 * zoom)


def _leader(canvas: NDArray[np.uint8], extent: Extent, nearest: Pixel, zoom: float) -> None:
    """Draw a thin line from a number to its object, if the object does not reach the number."""
    begin = _number_at(extent, zoom)
    if np.hypot(nearest[0] - begin[0], nearest[1] - begin[1]) > LEADER_PX * zoom:
        cv2.line(canvas, begin, nearest, (60, 60, 60), max(1, round(3 * zoom)), cv2.LINE_AA)
        cv2.line(canvas, begin, nearest, (250, 250, 250), max(1, round(1.5 * zoom)), cv2.LINE_AA)


def _label(canvas: NDArray[np.uint8], extent: Extent, mark: Mark, taken: Sequence[Extent], zoom: float) -> Extent:
    """Draw the text of a mark where it hides no earlier plate, or below the object if there is no such place."""
    left, top, right, bottom = extent
    across, gap = (left + right) // 2, round(14 * zoom)
    places = [(x, y) for x in (across, left, right) for y in (bottom + gap, top - gap)]
    scale = TEXT_SCALE * zoom
    plates = [_plate(canvas, mark.label, place, scale) for place in places]
    free = [place for place, plate in zip(places, plates, strict=True) if not any(_meet(plate, t) for t in taken)]
    return _tag(canvas, mark.label, (free or places)[0], mark.color, (255, 255, 255), scale)


def _meet(one: Extent, other: Extent) -> bool:
    """Return whether two rectangles have a pixel in common."""
    return one[0] <= other[2] and other[0] <= one[2] and one[1] <= other[3] and other[1] <= one[3]


def _plate(canvas: NDArray[np.uint8], text: str, middle: Pixel, scale: float) -> Extent:
    """Return left, top, right, bottom of the plate of a text, kept inside the picture."""
    (width, height), _ = cv2.getTextSize(text, FONT, scale, 1)
    half_w, half_h = width // 2 + 4, height // 2 + 4
    x = int(np.clip(middle[0], half_w + 2, canvas.shape[1] - half_w - 3))
    y = int(np.clip(middle[1], half_h + 2, canvas.shape[0] - half_h - 3))
    return x - half_w, y - half_h, x + half_w, y + half_h


def _tag(canvas: NDArray[np.uint8], text: str, middle: Pixel, ground: RGB, ink: RGB, scale: float) -> Extent:
    """Draw a text on a rounded plate."""
    plate = left, top, right, bottom = _plate(canvas, text, middle, scale)
    cv2.rectangle(canvas, (left, top), (right, bottom), ground, -1, cv2.LINE_AA)
    cv2.rectangle(canvas, (left, top), (right, bottom), (60, 60, 60), 1, cv2.LINE_AA)
    cv2.putText(canvas, text, (left + 4, bottom - 4), FONT, scale, ink, 1, cv2.LINE_AA)
    return plate
