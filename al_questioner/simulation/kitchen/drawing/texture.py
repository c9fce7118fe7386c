"""Surfaces: materials, printed labels, grain and table tops."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np

from al_questioner.domain import FloatArray, random_stream
from al_questioner.simulation.kitchen.drawing.images import resized

Color = tuple[float, float, float]
"""A colour, red, green, blue in [0, 1]; at the end, views are converted to OpenCV's order."""


@dataclass(frozen=True, eq=False)
class Decal:
    """A picture on a surface.

    Attributes:
        image: (h, w, 3) float32 in [0, 1], red-green-blue.
        mapping: 'wrap' around a vertical axis, 'box' around four walls, or 'top' looking down.
        size: 'wrap', 'box': lowest and highest z in metres; 'top': width and depth in metres.
        half: half width and depth of the box in metres ('box' only).
    """

    image: FloatArray
    mapping: str
    size: tuple[float, float]
    half: tuple[float, float] = (1.0, 1.0)


@dataclass(frozen=True, eq=False)
class Material:
    """Reflection of light by a surface.

    Attributes:
        color: red, green, blue in [0, 1].
        shine: strength of the highlight.
        sharpness: exponent of the highlight.
        grain: relative strength of mottling.
        grain_m: size of the mottling in metres.
        clear: share of the light that comes through from behind.
        decal: a picture on the surface.
    """

    color: Color
    shine: float = 0.1
    sharpness: float = 20.0
    grain: float = 0.06
    grain_m: float = 0.01
    clear: float = 0.0
    decal: Decal | None = None


def hsv(hue_deg: float, saturation: float, value: float) -> Color:
    """Return a colour by hue (degrees), saturation and value in [0, 1]."""
    return colorsys.hsv_to_rgb(hue_deg % 360 / 360, min(max(saturation, 0), 1), min(max(value, 0), 1))


def shifted(color: Color, hue_deg: float, tone: float) -> Color:
    """Return a colour turned around the colour wheel and made lighter (tone > 1) or darker."""
    hue, saturation, value = colorsys.rgb_to_hsv(*color)
    return hsv(hue * 360 + hue_deg, saturation, value * tone)


@lru_cache(maxsize=1)
def grain_tile() -> FloatArray:
    """Return (512, 512) smooth mottling of mean 0 and standard deviation 1, seamless: three octaves of noise."""
    rng = random_stream(0, 'world/grain')
    total = np.zeros((512, 512), dtype=np.float32)
    for size, weight in ((32, 1.0), (96, 0.7), (256, 0.5)):
        noise = np.pad(rng.standard_normal((size, size)).astype(np.float32), 2, mode='wrap')
        pad = 2 * 512 // size
        fine = resized(noise, (512 + 2 * pad, 512 + 2 * pad), cv2.INTER_CUBIC)
        total += weight * fine[pad : pad + 512, pad : pad + 512]
    return np.asarray((total - total.mean()) / total.std())


@lru_cache(maxsize=1)
def noise_tile() -> FloatArray:
    """Return (640, 640, 3) white Gaussian noise of standard deviation 1; a view takes a part of it as camera noise."""
    return random_stream(0, 'world/noise').standard_normal((640, 640, 3), dtype=np.float32)


TABLE_TILE_M = 0.002
"""Metres per pixel of a table top's picture."""

_TABLE_TOPS: tuple[tuple[Color, float, float], ...] = (
    ((0.64, 0.46, 0.29), 0.10, 1.0),
    ((0.47, 0.31, 0.19), 0.12, 1.0),
    ((0.80, 0.66, 0.47), 0.07, 1.0),
    ((0.74, 0.73, 0.71), 0.04, 0.0),
    ((0.38, 0.40, 0.43), 0.06, 0.0),
)


@lru_cache(maxsize=8)
def table_top(index: int) -> FloatArray:
    """Return the (600, 900, 3) picture of a table top, red-green-blue in [0, 1]: three woods, a light and a dark stone.

    Index 0 is the table of every scene unless the task asks for a variety of backgrounds.
    """
    color, contrast, wood = _TABLE_TOPS[index % len(_TABLE_TOPS)]
    rng = random_stream(index, 'world/table_top')
    if wood:
        streaks = resized(rng.standard_normal((150, 12), dtype=np.float32), (900, 600), cv2.INTER_CUBIC)
        fibres = resized(rng.standard_normal((600, 18), dtype=np.float32), (900, 600), cv2.INTER_CUBIC)
        planks = np.repeat(rng.normal(0, 0.7, 8), 75)[:, None].astype(np.float32)
        relief = 0.45 * streaks + 0.35 * fibres + planks
        relief[::75] -= 2.2
    else:
        relief = np.tile(grain_tile(), (2, 2))[:600, :900]
    lit = np.array(color, dtype=np.float32) * (1 + contrast * relief[..., None])
    return np.asarray(lit.clip(0, 1), dtype=np.float32)


def table_top_count() -> int:
    """Return the number of table tops."""
    return len(_TABLE_TOPS)


def blush_image(ground: Color, blush: Color, share: float) -> FloatArray:
    """Return a skin (32, 64, 3) that turns from one colour into another around the fruit; `share` has the second."""
    angles = np.linspace(-np.pi, np.pi, 64, dtype=np.float32)[None, :]
    heights = np.linspace(-1, 1, 32, dtype=np.float32)[:, None]
    side = np.cos(angles + 0.5 * heights) + 0.35 * grain_tile()[100:132, 100:164] - 0.3 * np.abs(heights)
    mix = np.clip(0.5 + (side - np.cos(np.pi * share)) / 0.9, 0, 1)[..., None]
    return np.asarray(np.array(ground) * (1 - mix) + np.array(blush) * mix, dtype=np.float32)


@lru_cache(maxsize=64)
def label_image(
    ground: Color, ink: Color, accent: Color, word: str, place: float, repeats: int = 2, motif: str = 'disc'
) -> FloatArray:
    """Return a printed label (96, 128 * repeats, 3), its design repeated: a band, a motif and a word.

    Every view of an object shows the same label. The motif, of the accent's colour like the band, is 'disc', 'stripes',
    'wave', 'blocks' or 'plain', and `place` in [0, 1] moves it.
    """
    paper, text, tint = ([round(255 * channel) for channel in color] for color in (ground, ink, accent))
    image = np.full((96, 128, 3), paper, dtype=np.uint8)
    row, column = int(56 + 18 * place), int(40 + 48 * (7 * place % 1))
    if motif == 'disc':
        cv2.circle(image, (column, row), 24, tint, -1, cv2.LINE_AA)
        cv2.circle(image, (column, row), 9, text, -1, cv2.LINE_AA)
    elif motif == 'stripes':
        for left in range(0, 128, 16):
            cv2.line(image, (left, 96), (left + 24, 44), tint, 6, cv2.LINE_AA)
    elif motif == 'wave':
        columns = np.arange(0, 129, 8)
        rows = row + 9 * np.sin(columns / 128 * 2 * np.pi)
        curve = np.stack([np.r_[columns, 128, 0], np.r_[rows, 96, 96]], axis=1).astype(np.int32)
        cv2.fillPoly(image, [curve], tint, cv2.LINE_AA)
    elif motif == 'blocks':
        cv2.rectangle(image, (0, 50), (128, 60), tint, -1)
        cv2.rectangle(image, (14, 68), (60, 88), tint, -1)
        cv2.rectangle(image, (72, 68), (114, 88), text, -1)
    if word:
        scale = min(1.25, 1.25 * 118 / cv2.getTextSize(word, cv2.FONT_HERSHEY_DUPLEX, 1.25, 3)[0][0])
        width = cv2.getTextSize(word, cv2.FONT_HERSHEY_DUPLEX, scale, 3)[0][0]
        cv2.putText(image, word, ((128 - width) // 2, 38), cv2.FONT_HERSHEY_DUPLEX, scale, text, 3, cv2.LINE_AA)
    return np.tile(image.astype(np.float32) / 255, (1, repeats, 1))
