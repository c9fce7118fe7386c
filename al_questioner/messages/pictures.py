"""Conversion of pictures to and from image messages, and RViz markers; the message classes are passed in."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import InputError, Scene

_COLOURS = (
    (0.90, 0.36, 0.23),
    (0.98, 0.75, 0.18),
    (0.30, 0.69, 0.31),
    (0.25, 0.47, 0.85),
    (0.61, 0.35, 0.71),
    (0.10, 0.68, 0.66),
    (0.55, 0.43, 0.33),
    (0.93, 0.47, 0.65),
)
"""Colours (red, green, blue) of the symbols in order; further symbols begin again with the first."""

_PENDING_COLOUR = (1.0, 1.0, 1.0)


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


@dataclass(frozen=True)
class MarkerTypes:
    """The message classes of a marker array."""

    array: Callable[..., Any]
    marker: Callable[..., Any]
    pose: Callable[..., Any]
    point: Callable[..., Any]
    vector: Callable[..., Any]
    colour: Callable[..., Any]
    constants: Any
    """The Marker class, for its constants DELETEALL, SPHERE and TEXT_VIEW_FACING."""


def markers(
    scene: Scene,
    beliefs: NDArray[np.float64],
    symbols: Sequence[str],
    pending: int | None,
    header: Any,
    types: MarkerTypes,
) -> Any:
    """Return a visualization_msgs/MarkerArray: a sphere and a text per object, given (n, |Y|) beliefs in the symbols.

    The object that the pending query asks about is larger and white.
    """
    constants = types.constants
    result = [types.marker(header=header, action=constants.DELETEALL)]
    for row, object_id in enumerate(scene.object_ids):
        x, y, z = (float(value) for value in scene.positions[row])
        best = int(beliefs[row].argmax())
        believed = f'{symbols[best]} {beliefs[row, best]:.0%}' if np.ptp(beliefs[row]) > 0 else 'unknown'
        red, green, blue = _PENDING_COLOUR if object_id == pending else _COLOURS[best % len(_COLOURS)]
        diameter = 0.08 if object_id == pending else 0.05
        colour = types.colour(r=red, g=green, b=blue, a=0.4 + 0.6 * float(beliefs[row, best]))
        result.append(
            types.marker(
                header=header,
                ns='objects',
                id=row,
                type=constants.SPHERE,
                pose=types.pose(position=types.point(x=x, y=y, z=z)),
                scale=types.vector(x=diameter, y=diameter, z=diameter),
                color=colour,
            )
        )
        result.append(
            types.marker(
                header=header,
                ns='beliefs',
                id=row,
                type=constants.TEXT_VIEW_FACING,
                pose=types.pose(position=types.point(x=x, y=y, z=z + 0.07)),
                scale=types.vector(x=0.0, y=0.0, z=0.03),
                color=types.colour(r=1.0, g=1.0, b=1.0, a=1.0),
                text=f'{object_id}: {believed}' + (' ?' if object_id == pending else ''),
            )
        )
    return types.array(markers=result)
