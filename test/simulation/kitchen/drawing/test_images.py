"""The channels of an image."""

from __future__ import annotations

import numpy as np

from al_questioner.simulation.kitchen.drawing.images import merged, planes


def test_channels_come_apart_and_together() -> None:
    """Otherwise colours would be swapped, or pixels."""
    image = np.random.default_rng(0).random((5, 7, 3), dtype=np.float32)
    assert planes(image).flags.c_contiguous
    np.testing.assert_array_equal(planes(image), image.transpose(2, 0, 1))
    np.testing.assert_array_equal(merged(planes(image)), image)
