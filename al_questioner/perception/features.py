"""Features of one object in a camera's view: its colour, size, shape and texture.

Only pixels of the mask count, so the background changes no feature. Colour and texture are measured at a
bounded resolution, so that an object looks much the same from near and far, and measuring takes a bounded time.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import InputError, View

_NAMES_BY_GROUP = (
    ('colour', ('lightness', 'green_red', 'blue_yellow', 'lightness_spread', 'saturation_spread')),
    ('colour', ('red', 'yellow', 'green', 'cyan', 'blue', 'magenta')),
    ('size', ('length', 'width', 'area', 'depth')),
    ('shape', ('aspect', 'solidity', 'extent', 'circularity', 'hu_1', 'hu_2', 'hu_3')),
    ('texture', ('edges', 'fine', 'coarse', 'entropy')),
)
VIEW_FEATURE_NAMES = tuple(f'{group}_{name}' for group, names in _NAMES_BY_GROUP for name in names)
"""Names of the entries of `view_features`; the part before the first underscore is the group."""

NOMINAL_DISTANCE = 0.8
"""Distance in metres of an object without a depth reading: an object on a table within an arm's reach."""

MEASURING_SIZE = 64
"""Longest side, in pixels, of an object whose colour and texture are measured; larger ones are scaled down to it."""

HUES = 6
"""Number of hues, evenly spaced on the colour wheel, starting at red."""

EDGE_THRESHOLD = 0.05
"""Change of lightness per pixel, as a share of its range, above which a pixel is an edge."""

ENTROPY_BINS = 32
"""Number of lightness levels that the entropy distinguishes; it is at most 5 bits."""

HU_FLOOR = 1e-5
"""Small number added to Hu's invariants before the logarithm."""


@dataclass(frozen=True, eq=False)
class _Patch:
    """The part of a crop that shows the object.

    Attributes:
        color: (h, w, 3), blue-green-red; the background has the mean colour of the object.
        mask: (h, w), 1 on the object.
    """

    color: NDArray[np.uint8]
    mask: NDArray[np.uint8]

    @cached_property
    def lab(self) -> NDArray[np.uint8]:
        """Colours as OpenCV stores them, (h, w, 3): L* scaled from 100 to 255, a* and b* shifted by 128."""
        return np.asarray(cv2.cvtColor(self.color, cv2.COLOR_BGR2Lab), dtype=np.uint8)


def view_features(view: View) -> NDArray[np.float32]:
    """Return the (len(VIEW_FEATURE_NAMES),) float32 features of one object, all finite.

    - colour: mean L*, a*, b* (unit: L* range 1), spread of L* and of the saturation, and how strongly the object shows
      each of six hues. This is the mean over its pixels of their chroma, shared between the two nearest hues. So a grey
      pixel has no hue instead of a random one.
    - size: length and width (m) of the tightest rectangle around the silhouette, area (m^2) of the silhouette, both in
      the plane at the object's median depth; and the extent in depth (m), 5th to 95th percentile. Without any depth
      reading on the object, its distance is `NOMINAL_DISTANCE` and its extent in depth 0.
    - shape: width / length; area / area of the convex hull; area / area of the rectangle; 4 pi area / (perimeter of the
      hull)^2; and log10(h + 1e-5) of Hu's first three invariants. The other invariants are products of higher degree,
      mostly noise on a small mask. The added 1e-5 keeps the logarithm stable at a symmetric shape's zeros.
    - texture: share of edge pixels, standard deviation of the lightness in a fine and in a coarse band, entropy (bits).

    Raises:
        InputError: colour, depth and mask of different sizes, an empty mask, or focal lengths that are not positive.
    """
    _check(view)
    mask = view.mask.astype(bool).view(np.uint8)
    left, top, width, height = cv2.boundingRect(mask)
    window = (slice(top, top + height), slice(left, left + width))
    silhouette = np.ascontiguousarray(mask[window])
    outline = _outline(silhouette)
    patch = _patch(view.color[window], silhouette)
    return np.array(
        [*_colour(patch), *_size(view, window, silhouette, outline), *_shape(silhouette, outline), *_texture(patch)],
        dtype=np.float32,
    )


def _check(view: View) -> None:
    shape = view.mask.shape
    if len(shape) != 2 or view.color.shape != (*shape, 3) or view.depth.shape != shape:
        raise InputError(
            f'colour {view.color.shape}, depth {view.depth.shape} and mask {shape} of a view must be'
            ' (h, w, 3), (h, w) and (h, w)'
        )
    if view.color.dtype != np.uint8:
        raise InputError(f'the colour image of a view must be uint8, not {view.color.dtype}')
    if not view.mask.any():
        raise InputError('the mask is empty: it marks no pixel as the object')
    for name, length in (('fx', view.camera.fx), ('fy', view.camera.fy)):
        if not (np.isfinite(length) and length > 0):
            raise InputError(f'the focal length {name} must be a number above 0, not {length}')


def _outline(silhouette: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return the (k, 2) corners, in pixels, of the convex hull of the silhouette; each pixel is a full square."""
    contours, _ = cv2.findContours(silhouette, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    centres = cv2.convexHull(np.concatenate(contours)).reshape(-1, 1, 2)
    corners = centres + np.array([[-0.5, -0.5], [-0.5, 0.5], [0.5, -0.5], [0.5, 0.5]])
    hull: NDArray[np.float32] = cv2.convexHull(corners.reshape(-1, 2).astype(np.float32)).reshape(-1, 2)
    return hull


def _patch(color: NDArray[np.uint8], silhouette: NDArray[np.uint8]) -> _Patch:
    height, width = silhouette.shape
    scale = MEASURING_SIZE / max(height, width)
    cut, mask = cv2.copyTo(color, silhouette), silhouette
    if scale < 1:
        size = (max(1, round(width * scale)), max(1, round(height * scale)))
        coverage = cv2.resize(silhouette.astype(np.float32), size, interpolation=cv2.INTER_AREA)
        # A pixel belongs to the object if half of it is covered; if none is, those with the largest cover belong to it.
        mask = (coverage >= min(0.5, float(coverage.max()))).astype(np.uint8)
        share = np.where(mask, coverage, 1)
        seen = cv2.resize(cut, size, interpolation=cv2.INTER_AREA) / cv2.merge([share, share, share])
        cut = np.minimum(np.rint(seen), 255).astype(np.uint8)
    even = np.full(cut.shape, np.rint(cv2.mean(cut, mask)[:3]), dtype=np.uint8)
    cv2.copyTo(cut, mask, even)
    return _Patch(even, mask)


def _colour(patch: _Patch) -> list[float]:
    lab, lab_spread = cv2.meanStdDev(patch.lab, mask=patch.mask)
    lightness, green_red, blue_yellow = (lab.ravel() - (0, 128, 128)) / 255
    inside = np.flatnonzero(patch.mask)
    hsv = cv2.split(cv2.cvtColor(patch.color, cv2.COLOR_BGR2HSV_FULL))
    hue, saturation, value = (channel.take(inside) for channel in hsv)
    chroma = saturation * (value / 255**2)
    position = hue * (HUES / 256)
    lower = position.astype(np.intp)
    share = position - lower
    hues = np.bincount(lower, chroma * (1 - share), HUES) + np.bincount((lower + 1) % HUES, chroma * share, HUES)
    return [lightness, green_red, blue_yellow, lab_spread[0, 0] / 255, saturation.std() / 255, *(hues / chroma.size)]


def _size(
    view: View, window: tuple[slice, slice], silhouette: NDArray[np.uint8], outline: NDArray[np.float32]
) -> list[float]:
    depth = view.depth[window]
    # For 16-bit numbers, numpy's stable sort is a fast radix sort.
    readings = np.sort(depth[(silhouette > 0) & (depth > 0)], kind='stable')
    if readings.size:
        near, distance, far = readings[[round(share * (readings.size - 1)) for share in (0.05, 0.5, 0.95)]] / 1000.0
    else:
        near = distance = far = NOMINAL_DISTANCE
    metres_per_pixel = np.array([distance / view.camera.fx, distance / view.camera.fy])
    _, sides, _ = cv2.minAreaRect((outline * metres_per_pixel).astype(np.float32))
    area = np.count_nonzero(silhouette) * metres_per_pixel.prod()
    return [max(sides), min(sides), area, far - near]


def _shape(silhouette: NDArray[np.uint8], outline: NDArray[np.float32]) -> list[float]:
    area = np.count_nonzero(silhouette)
    _, sides, _ = cv2.minAreaRect(outline)
    hu = cv2.HuMoments(cv2.moments(silhouette, binaryImage=True)).ravel()[:3]
    return [
        min(sides) / max(sides),
        area / cv2.contourArea(outline),
        area / (sides[0] * sides[1]),
        4 * np.pi * area / cv2.arcLength(outline, closed=True) ** 2,
        *np.log10(np.abs(hu) + HU_FLOOR),
    ]


def _texture(patch: _Patch) -> list[float]:
    lightness = patch.lab[..., 0] / np.float32(255)
    # The rim of the object is shape, not texture.
    inner = cv2.erode(patch.mask, np.ones((3, 3), np.uint8))
    if not inner.any():
        inner = patch.mask
    across = cv2.Sobel(lightness, cv2.CV_32F, 1, 0, scale=1 / 8)
    down = cv2.Sobel(lightness, cv2.CV_32F, 0, 1, scale=1 / 8)
    within = np.flatnonzero(inner)
    # Not cv2.magnitude: its rounding depends on memory addresses, so a pixel at the threshold would come and go.
    edges = np.sqrt(across**2 + down**2).take(within) > EDGE_THRESHOLD
    smooth = cv2.GaussianBlur(lightness, (0, 0), 1.0)
    smoother = cv2.GaussianBlur(lightness, (0, 0), 4.0)
    levels = np.minimum((lightness.take(within) * ENTROPY_BINS).astype(np.intp), ENTROPY_BINS - 1)
    shares = np.bincount(levels) / levels.size
    shares = shares[shares > 0]
    bands = (_spread(lightness - smooth, inner), _spread(smooth - smoother, inner))
    return [edges.mean(), *bands, float(-shares @ np.log2(shares))]


def _spread(image: NDArray[Any], mask: NDArray[Any]) -> float:
    """Return the standard deviation of an image within a mask."""
    return float(cv2.meanStdDev(image, mask=mask)[1][0, 0])
