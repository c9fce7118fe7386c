"""Markers for RViz and Foxglove: what the learner believes and asks, and what things are taken for.

The message classes are passed in.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import NO_SYMBOL, Recognition, Scene

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

_WHITE = (1.0, 1.0, 1.0)
_GREY = (0.55, 0.55, 0.55)
_BELIEF_HEIGHT, _NAME_HEIGHT, _QUESTION_HEIGHT = 0.07, 0.12, 0.25
"""Metres above a thing, or for the question above all of them, at which texts stand, one above the other."""


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
    """The Marker class, for its constants DELETEALL, SPHERE, CUBE_LIST and TEXT_VIEW_FACING."""


def markers(
    scene: Scene,
    beliefs: NDArray[np.float64],
    symbols: Sequence[str],
    pending: int | None,
    header: Any,
    types: MarkerTypes,
    question: str = '',
) -> Any:
    """Return a visualization_msgs/MarkerArray: a sphere and a text per object, given (n, |Y|) beliefs in the symbols.

    The object that the pending query asks about is larger and white; the question, if there is one, stands above all.
    """
    constants = types.constants
    result = [types.marker(header=header, action=constants.DELETEALL)]
    for row, object_id in enumerate(scene.object_ids):
        x, y, z = (float(value) for value in scene.positions[row])
        best = int(beliefs[row].argmax())
        believed = f'{symbols[best]} {beliefs[row, best]:.0%}' if np.ptp(beliefs[row]) > 0 else 'unknown'
        red, green, blue = _WHITE if object_id == pending else _COLOURS[best % len(_COLOURS)]
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
        text = f'{object_id}: {believed}' + (' ?' if object_id == pending else '')
        result.append(_text('beliefs', row, text, (x, y, z + _BELIEF_HEIGHT), header, types))
    if question:
        x, y = (float(value) for value in scene.positions[:, :2].mean(axis=0)) if len(scene) else (0.0, 0.0)
        top = float(scene.positions[:, 2].max(initial=0.0))
        result.append(_text('question', 0, question, (x, y, top + _QUESTION_HEIGHT), header, types))
    return types.array(markers=result)


def recognised_markers(recognition: Recognition, header: Any, types: MarkerTypes) -> Any:
    """Return a visualization_msgs/MarkerArray: below each thing a tile of the colour of its name, above it the name.

    What is not known is white, with a question mark before the name that is most probable; what is of none is grey.
    The fainter a tile, the less probable is the name.
    """
    constants, column = types.constants, {name: i for i, name in enumerate((*recognition.symbols, NO_SYMBOL))}
    # One marker for all tiles: each marker costs as much as all the numbers in it.
    tiles = types.marker(
        header=header,
        ns='recognised',
        type=constants.CUBE_LIST,
        pose=types.pose(),
        scale=types.vector(x=0.07, y=0.07, z=0.005),
    )
    result = [types.marker(header=header, action=constants.DELETEALL), tiles]
    for row, thing in enumerate(recognition.things):
        x, y, z = thing.position
        colour = _GREY if thing.best == NO_SYMBOL else _COLOURS[column[thing.best] % len(_COLOURS)]
        red, green, blue = colour if thing.is_known else _WHITE
        tiles.points.append(types.point(x=x, y=y, z=z))
        tiles.colors.append(types.colour(r=red, g=green, b=blue, a=0.3 + 0.7 * thing.probability))
        name = f'{"" if thing.is_known else "? "}{thing.best} {thing.probability:.0%}'
        result.append(_text('names', row, name, (x, y, z + _NAME_HEIGHT), header, types))
    return types.array(markers=result)


def _text(
    namespace: str, number: int, text: str, position: tuple[float, float, float], header: Any, types: MarkerTypes
) -> Any:
    x, y, z = position
    return types.marker(
        header=header,
        ns=namespace,
        id=number,
        type=types.constants.TEXT_VIEW_FACING,
        pose=types.pose(position=types.point(x=x, y=y, z=z)),
        scale=types.vector(x=0.0, y=0.0, z=0.03),
        color=types.colour(r=1.0, g=1.0, b=1.0, a=1.0),
        text=text,
    )
