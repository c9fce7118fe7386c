"""Conversion of pictures to and from image messages; the message classes are passed in."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import InputError


def image(
    picture: NDArray[np.uint8], header: Any, image_type: Callable[..., Any], octets: Callable[[bytes], Any]
) -> Any:
    """Return a sensor_msgs/Image of an (h, w, 3) uint8 red-green-blue picture."""
    height, width, _ = picture.shape
    return image_type(
        header=header,
        height=height,
        width=width,
        encoding='rgb8',
        is_bigendian=0,
        step=3 * width,
        data=octets(np.ascontiguousarray(picture).tobytes()),
    )


def picture_of_image(message: Any) -> NDArray[np.uint8]:
    """Return the (h, w, 3) uint8 red-green-blue picture that a sensor_msgs/Image holds.

    Raises:
        InputError: another encoding than rgb8, no pixel, or fewer bytes than the size requires.
    """
    height, width, step = message.height, message.width, message.step
    if message.encoding != 'rgb8':
        raise InputError(f'the picture is encoded as {message.encoding!r}, expected rgb8')
    data = np.frombuffer(memoryview(message.data).cast('B'), np.uint8)
    if height * width == 0 or step < 3 * width or len(data) < step * height:
        raise InputError(f'the picture holds {len(data)} bytes, which do not make {height} rows of {width} pixels')
    rows = data[: step * height].reshape(height, step)[:, : 3 * width]
    return np.ascontiguousarray(rows).reshape(height, width, 3)
