"""The OpenCV filters that drawing needs, on float32 images."""

from __future__ import annotations

import cv2
import numpy as np

from al_questioner.domain import FloatArray


def resized(image: FloatArray, size: tuple[int, int], interpolation: int = cv2.INTER_LINEAR) -> FloatArray:
    """An image (h, w) or (h, w, c) brought to (columns, rows)."""
    return np.asarray(cv2.resize(image, size, interpolation=interpolation), dtype=np.float32)


def blurred(image: FloatArray, sigma: float, reach: int = 0) -> FloatArray:
    """A Gaussian blur; `reach` pixels wide to either side, or as far as sigma asks for."""
    kernel = (2 * reach + 1, 2 * reach + 1) if reach else (0, 0)
    return np.asarray(cv2.GaussianBlur(image, kernel, sigma), dtype=np.float32)


def planes(image: FloatArray) -> FloatArray:
    """The (c, h, w) channels of an image (h, w, c): numpy is slow on short rows, and pixels are short rows."""
    return np.stack(cv2.split(image))


def merged(channels: FloatArray) -> FloatArray:
    """The image (h, w, c) of these (c, h, w) channels."""
    return np.asarray(cv2.merge(list(channels)), dtype=np.float32)
