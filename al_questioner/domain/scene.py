"""Views, observations and scenes: the data that the robot perceives."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from al_questioner.domain.errors import InputError, SceneError
from al_questioner.domain.names import listed

FloatArray = NDArray[np.floating]


@dataclass(frozen=True)
class Camera:
    """Pinhole intrinsics of the full frame, in pixels."""

    fx: float
    fy: float
    cx: float
    cy: float


@dataclass(frozen=True, eq=False)
class View:
    """One object as an RGB-D camera sees it: a crop of the frame.

    Attributes:
        color: (h, w, 3) uint8, blue-green-red as in OpenCV.
        depth: (h, w) uint16 millimetres, 0 where the sensor has no reading.
        mask: (h, w) bool, true on the object.
        origin: (column, row) of the crop's top left pixel in the frame, 0-based.
    """

    color: NDArray[np.uint8]
    depth: NDArray[np.uint16]
    mask: NDArray[np.bool_]
    camera: Camera
    origin: tuple[int, int]


@dataclass(frozen=True, eq=False)
class Observation:
    """One object as the robot perceives it at one moment: a view, and the readings of its other sensors.

    Attributes:
        object_id: identifies the object as long as it stays in the scene.
        position: (x, y, z) metres in the table's frame.
        sensors: reading by name; a name starts with its feature group (`weight_kg`, `base_x`, `arms_left_1`).
    """

    object_id: int
    position: tuple[float, float, float]
    view: View
    sensors: Mapping[str, float]


def group_of(feature_name: str) -> str:
    """Return the group of a feature, as a person would name it: the part of its name before the first underscore."""
    return feature_name.split('_', 1)[0]


def groups_of(feature_names: Iterable[str]) -> tuple[str, ...]:
    """Return the distinct groups of features, in the order in which they occur."""
    return tuple(dict.fromkeys(map(group_of, feature_names)))


@dataclass(frozen=True, eq=False)
class Scene:
    """The objects seen in one turn, as feature vectors; one observation per object. There may be none.

    Lists are accepted in place of tuples and arrays. Values that are not an array of floating-point numbers are
    converted to float32.

    Attributes:
        object_ids: one distinct non-negative id per object.
        positions: (n, 3) float32, metres in the table's frame.
        features: (n, m) float32, not standardised.
        feature_names: m distinct names; the group of a feature is `group_of` its name.

    Raises:
        SceneError: no feature, a shape that does not fit, an id that is not a whole number, a name that is not a text,
            a repeated id or name, or a value that is not a finite number.
    """

    object_ids: tuple[int, ...]
    positions: NDArray[np.float32]
    features: NDArray[np.float32]
    feature_names: tuple[str, ...]

    def __post_init__(self) -> None:
        for name, read in (
            ('object_ids', _ids),
            ('feature_names', _names),
            ('positions', _numbers),
            ('features', _numbers),
        ):
            object.__setattr__(self, name, read(getattr(self, name), name))
        n, m = len(self.object_ids), len(self.feature_names)
        if m == 0:
            raise SceneError('the scene has no features')
        if self.features.shape != (n, m):
            raise SceneError(f'features have shape {self.features.shape}, expected {(n, m)}')
        if self.positions.shape != (n, 3):
            raise SceneError(f'positions have shape {self.positions.shape}, expected {(n, 3)}')
        if len(set(self.object_ids)) < n:
            raise SceneError('an object id occurs twice in the scene')
        if min(self.object_ids, default=0) < 0:
            raise SceneError('an object id is negative')
        if len(set(self.feature_names)) < m:
            raise SceneError('a feature name occurs twice in the scene')
        finite = np.isfinite(self.features)
        if not finite.all():
            row, column = np.argwhere(~finite)[0]
            where = f'feature {self.feature_names[column]} of object {self.object_ids[row]}'
            raise SceneError(f'{where} is not finite ({self.features[row, column]})')
        if not np.isfinite(self.positions).all():
            row = int(np.argwhere(~np.isfinite(self.positions))[0][0])
            raise SceneError(f'the position of object {self.object_ids[row]} is not finite')

    def __len__(self) -> int:
        return len(self.object_ids)

    def equals(self, other: Scene) -> bool:
        """Return whether another scene is the same to the last bit."""
        return (
            self.object_ids == other.object_ids
            and self.feature_names == other.feature_names
            and self.features.tobytes() == other.features.tobytes()
            and self.positions.tobytes() == other.positions.tobytes()
        )

    def index_of(self, object_id: int) -> int:
        """Return the row of an object.

        Raises:
            KeyError: the object is not in the scene.
        """
        try:
            return self.object_ids.index(object_id)
        except ValueError:
            raise KeyError(object_id) from None

    def features_of(self, object_id: int) -> FloatArray:
        """Return the (m,) features of an object.

        Raises:
            InputError: the object is not in the scene.
        """
        if object_id not in self.object_ids:
            raise InputError(f'object {object_id} is not in the scene')
        row: FloatArray = self.features[self.index_of(object_id)]
        return row


def _ids(values: Iterable[SupportsIndex], what: str) -> tuple[int, ...]:
    try:
        return tuple(map(operator.index, values))
    except TypeError:
        raise SceneError(f'{what} must be whole numbers, not {values!r}') from None


def _names(values: Iterable[str], what: str) -> tuple[str, ...]:
    names = listed(values)
    if names is None:
        raise SceneError(f'{what} must be a list of names, not {values!r}')
    return names


def _numbers(values: ArrayLike, what: str) -> FloatArray:
    """Return a floating-point array as it is, so that measured values keep every bit, and anything else as float32."""
    if isinstance(values, np.ndarray) and np.issubdtype(values.dtype, np.floating):
        return values
    try:
        with np.errstate(over='ignore'):
            return np.asarray(values, dtype=np.float32)
    except (TypeError, ValueError):
        raise SceneError(f'{what} must be rows of numbers, all of the same length') from None
