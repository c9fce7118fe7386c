"""Structured-light depth camera, which adds noise, quantisation and holes to a true depth image."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray
from al_questioner.simulation.kitchen.drawing.images import resized
from al_questioner.simulation.task import CameraParameters

_BASELINE_M = 0.075
"""Distance of the Kinect's projector from its infrared camera, in metres."""


def measure_depth(
    thing: FloatArray,
    table: FloatArray,
    mask: NDArray[np.bool_],
    glare: FloatArray,
    camera: CameraParameters,
    rng: np.random.Generator,
) -> NDArray[np.uint16]:
    """Return depth readings in millimetres, 0 where there is none.

    Noise and quantisation follow Khoshelham and Elberink (Sensors 12, 2012): the sensor measures disparity f b / Z with
    constant noise and steps, so that both grow with the square of the depth.

    Args:
        thing: (h, w) metres to the object, valid where `mask` is true.
        table: (h, w) metres to the table behind it.
        mask: (h, w) the object.
        glare: (h, w) in [0, 1], disturbance of the sensor by a highlight or a transparent surface.
        camera: noise levels.
        rng: source of the noise.
    """
    height, width = mask.shape
    depth = np.where(mask, thing, table)
    depth += camera.depth_noise_m * depth**2 * rng.standard_normal(depth.shape, dtype=np.float32)
    if camera.disparity_step > 0:
        disparity = camera.focal_px * _BASELINE_M / depth
        depth = camera.focal_px * _BASELINE_M / (np.rint(disparity / camera.disparity_step) * camera.disparity_step)

    solid = mask.astype(np.uint8)
    outline = cv2.morphologyEx(solid, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0
    patches = rng.random((height // 4 + 2, width // 4 + 2), dtype=np.float32)
    patches = resized(patches, (width, height))
    specks = rng.random((height, width), dtype=np.float32)
    chance = 0.5 * (patches + specks)
    holes = outline & (chance < _quantile(camera.edge_holes))
    holes |= _shadow(solid, thing, table, camera.focal_px)
    holes |= specks < camera.random_holes
    holes |= (glare > 0.25) & (chance < _quantile(camera.shiny_holes))
    millimetres = np.rint(depth * 1000)
    millimetres[holes] = 0
    return np.asarray(millimetres, dtype=np.uint16)


def _quantile(share: float) -> float:
    """Return the threshold below which a `share` of means of two uniform numbers lies (triangular distribution)."""
    return float(np.sqrt(share / 2) if share < 0.5 else 1 - np.sqrt((1 - share) / 2))


def _shadow(solid: NDArray[np.uint8], thing: FloatArray, table: FloatArray, focal_px: float) -> NDArray[np.bool_]:
    """Return the strip of table to the left of the object that the infrared projector does not reach."""
    inside = solid > 0
    near, far = float(thing[inside].mean()), float(table[inside].mean())
    strip = round(focal_px * _BASELINE_M * max(0.0, 1 / near - 1 / far))
    if strip < 1:
        return np.zeros(solid.shape, dtype=bool)
    reach = cv2.dilate(solid, np.ones((1, 2 * strip + 1), np.uint8), anchor=(0, 0))
    return np.asarray((reach > 0) & (solid == 0))
