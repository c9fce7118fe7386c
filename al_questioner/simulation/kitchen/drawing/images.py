"""OpenCV filters for drawing, on float32 images."""

from __future__ import annotations

import cv2
import numpy as np

from al_questioner.domain import FloatArray


def resized(image: FloatArray, size: tuple[int, int], interpolation: int = cv2.INTER_LINEAR) -> FloatArray:
    """Return an image (h, w) or (h, w, c) resized to (columns, rows)."""
    return np.asarray(cv2.resize(image, size, interpolation=interpolation), dtype=np.float32)


def blurred(image: FloatArray, sigma: float, reach: int = 0) -> FloatArray:
    """Return an image with a Gaussian blur, `reach` pixels wide to either side, or as far as sigma needs."""
    kernel = (2 * reach + 1, 2 * reach + 1) if reach else (0, 0)
    return np.asarray(cv2.GaussianBlur(image, kernel, sigma), dtype=np.float32)


def planes(image: FloatArray) -> FloatArray:
    """Return the (c, h, w) channels of an image (h, w, c), because numpy is slow on short rows such as pixels."""
    return np.stack(cv2.split(image))


def merged(channels: FloatArray) -> FloatArray:
    """Return the image (h, w, c) of these (c, h, w) channels."""
    return np.asarray(cv2.merge(list(channels)), dtype=np.float32)
