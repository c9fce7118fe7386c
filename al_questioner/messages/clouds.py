"""Conversion of scenes and decisions to and from PointCloud2: one point per object, or one per candidate.

The message classes are passed in, so that the same code serves rclpy and bag readers.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import DECISION_FEATURES, Action, Decision, QueryKind, Scene, SceneError

_FORMATS = {1: 'i1', 2: 'u1', 3: 'i2', 4: 'u2', 5: 'i4', 6: 'u4', 7: 'f4', 8: 'f8'}
"""Format of numpy for each datatype of sensor_msgs/PointField."""
_DATATYPES = {format_: datatype for datatype, format_ in _FORMATS.items()}

_KINDS = tuple(QueryKind)
_NO_SYMBOL = -1
_NO_OBJECT = 2**32 - 1
POSITION = (('x', 'f4'), ('y', 'f4'), ('z', 'f4'))
"""Fields that RViz and Foxglove need to draw a cloud."""
_SCENE_HEAD = (*POSITION, ('object_id', 'u4'))
_DECISION_FIELDS = (
    ('kind', 'u1'),
    ('chosen', 'u1'),
    ('object_id', 'u4'),
    ('symbol', 'i4'),
    *((name, 'f8') for name in DECISION_FEATURES),
    ('utility', 'f8'),
)
"""Fields that every decision cloud has; old recordings have no positions."""

MAXIMAL_OBJECTS = 2_000
"""Largest number of objects in a scene; with this number, one turn takes about half a minute to compute."""
MAXIMAL_CANDIDATES = 100_000
"""Largest number of candidates in a decision."""
MAXIMAL_FIELDS = 10_000


@dataclass(frozen=True)
class CloudTypes:
    """The two message classes of a cloud, and the container of its bytes."""

    cloud: Callable[..., Any]
    field: Callable[..., Any]
    octets: Callable[[bytes], Any]


def cloud_of_scene(scene: Scene, header: Any, types: CloudTypes) -> Any:
    """Return the `objects` cloud of a scene: `x y z object_id`, then one float32 field per feature."""
    points = np.empty(len(scene), dtype=[*_SCENE_HEAD, *((name, 'f4') for name in scene.feature_names)])
    points['x'], points['y'], points['z'] = scene.positions.T
    points['object_id'] = scene.object_ids
    for column, name in enumerate(scene.feature_names):
        points[name] = scene.features[:, column]
    return cloud_of_points(points, header, types)


def scene_of_cloud(cloud: Any, known_features: Sequence[str] = ()) -> Scene:
    """Return the scene that an `objects` cloud shows; a cloud without points shows that no object is there.

    Such a cloud need not have the fields of the features that earlier scenes have made known.

    Raises:
        SceneError: a field is missing, or the layout contradicts itself, or the scene is unusable.
    """
    if not cloud.width * cloud.height and (known_features or not cloud.fields):
        if not known_features:
            raise SceneError('the cloud holds neither points nor fields, so its features are unknown')
        nothing = np.empty((0, 3), np.float32), np.empty((0, len(known_features)), np.float32)
        return Scene((), *nothing, tuple(known_features))
    points = _points(cloud, MAXIMAL_OBJECTS)
    names = points.dtype.names or ()
    missing = [name for name, _ in _SCENE_HEAD if name not in names]
    if missing:
        raise SceneError(f'the objects cloud has no field {", ".join(missing)}')
    features = tuple(name for name in names if name not in {head for head, _ in _SCENE_HEAD})
    # A value that does not fit into 32 bits becomes infinite, which a scene rejects.
    with np.errstate(over='ignore', invalid='ignore'):
        ids = points['object_id']
        if not np.array_equal(ids, ids.astype(np.uint32)) or (ids == _NO_OBJECT).any():
            raise SceneError('an object_id of the objects cloud is no uint32 below 2^32 - 1')
        columns = [points[name].astype(np.float32) for name in features]
        positions = np.stack([points[axis].astype(np.float32) for axis in 'xyz'], axis=1)
    return Scene(
        object_ids=tuple(int(object_id) for object_id in ids),
        positions=positions,
        features=np.stack(columns, axis=1) if columns else np.empty((len(points), 0), np.float32),
        feature_names=features,
    )


def cloud_of_decision(
    decision: Decision, symbols: tuple[str, ...], header: Any, types: CloudTypes, scene: Scene | None = None
) -> Any:
    """Return the `decision` cloud: one point per candidate.

    `x y z` is the position of the candidate's object, NaN if it has none. `kind` is the position in (label,
    demonstration, feature_subset, no_query, relevance), `symbol` the position in the episode's symbols. If a candidate
    names none, `object_id` is 2^32 - 1 and `symbol` -1. `chosen` is 1 for one point. Without the scene no candidate has
    a position.
    """
    places = {} if scene is None else dict(zip(scene.object_ids, scene.positions, strict=True))
    nowhere = np.full(3, np.nan, np.float32)
    # Zeros, so that the padding bytes between the fields are always the same.
    points = np.zeros(len(decision.candidates), dtype=np.dtype([*POSITION, *_DECISION_FIELDS], align=True))
    for row, action in enumerate(decision.candidates):
        place = nowhere if action.object_id is None else places.get(action.object_id, nowhere)
        points['x'][row], points['y'][row], points['z'][row] = place
        points['kind'][row] = _KINDS.index(action.kind)
        points['object_id'][row] = _NO_OBJECT if action.object_id is None else action.object_id
        points['symbol'][row] = _NO_SYMBOL if action.symbol is None else symbols.index(action.symbol)
    for column, name in enumerate(DECISION_FEATURES):
        points[name] = decision.features[:, column]
    points['utility'] = decision.utilities
    points['chosen'] = np.arange(len(points)) == decision.chosen
    return cloud_of_points(points, header, types)


def decision_of_cloud(cloud: Any, symbols: tuple[str, ...], turn: int) -> Decision:
    """Return the decision that a `decision` cloud holds, without its query.

    Raises:
        SceneError: the layout is not that of a decision, or not exactly one candidate is chosen.
    """
    points = _points(cloud, MAXIMAL_CANDIDATES)
    missing = [name for name, _ in _DECISION_FIELDS if name not in (points.dtype.names or ())]
    if missing:
        raise SceneError(f'the decision cloud has no field {", ".join(missing)}')
    chosen = np.flatnonzero(points['chosen'])
    if len(chosen) != 1:
        raise SceneError(f'the decision cloud marks {len(chosen)} candidates as chosen, expected 1')
    known = (('kind', 0, len(_KINDS)), ('symbol', _NO_SYMBOL, len(symbols)), ('object_id', 0, _NO_OBJECT + 1))
    for name, least, end in known:
        values = points[name]
        if not ((least <= values) & (values < end) & (values == np.floor(values))).all():
            raise SceneError(f'the decision cloud names a {name} that does not exist')
    kinds = [_KINDS[int(kind)] for kind in points['kind']]
    ids = [None if object_id == _NO_OBJECT else int(object_id) for object_id in points['object_id']]
    named = [None if symbol == _NO_SYMBOL else symbols[int(symbol)] for symbol in points['symbol']]
    return Decision(
        turn=turn,
        candidates=tuple(map(Action, kinds, ids, named)),
        features=np.stack([points[name].astype(np.float64) for name in DECISION_FEATURES], axis=1),
        utilities=points['utility'].astype(np.float64),
        chosen=int(chosen[0]),
        query=None,
    )


def cloud_of_points(points: NDArray[np.void], header: Any, types: CloudTypes) -> Any:
    """Return a cloud of structured points; among their fields are those of `POSITION`."""
    layout = points.dtype
    fields = [
        types.field(name=name, offset=offset, datatype=_DATATYPES[kind.str[1:]], count=1)
        for name, (kind, offset, *_) in (layout.fields or {}).items()
    ]
    return types.cloud(
        header=header,
        height=1,
        width=len(points),
        fields=fields,
        is_bigendian=False,
        point_step=layout.itemsize,
        row_step=layout.itemsize * len(points),
        data=types.octets(points.tobytes()),
        is_dense=bool(np.isfinite([points[axis] for axis, _ in POSITION]).all()),
    )


def _points(cloud: Any, most: int) -> NDArray[np.void]:
    """Return the points of any cloud with scalar fields, with any byte order, padding and rows; reject too many."""
    if any(field.count != 1 for field in cloud.fields):
        raise SceneError('a field of the cloud holds more than one value a point')
    count = cloud.width * cloud.height
    if count > most:
        raise SceneError(f'the cloud has {count} points, at most {most} are read')
    if len(cloud.fields) > MAXIMAL_FIELDS:
        raise SceneError(f'the cloud has {len(cloud.fields)} fields, at most {MAXIMAL_FIELDS} are read')
    if count == 0:
        return np.empty(0, _layout(cloud))
    if cloud.point_step == 0:
        raise SceneError('the points of the cloud hold no bytes')
    data = np.frombuffer(memoryview(cloud.data).cast('B'), np.uint8)
    row = cloud.point_step * cloud.width
    if cloud.row_step < row or len(data) < cloud.row_step * cloud.height:
        size = f'{cloud.height} x {cloud.width} points of {cloud.point_step} bytes'
        raise SceneError(f'the cloud holds {len(data)} bytes, too few for {size}')
    # Only after the checks: numpy computes with 32 bits here, and would read beyond the data.
    layout = _layout(cloud)
    rows = data[: cloud.row_step * cloud.height].reshape(cloud.height, cloud.row_step)[:, :row]
    return np.ascontiguousarray(rows).reshape(-1).view(layout)


def _layout(cloud: Any) -> np.dtype[np.void]:
    """Return where the values of a point lie in its bytes; reject values that lie beyond its end."""
    order = '>' if cloud.is_bigendian else '<'
    formats = [_FORMATS.get(field.datatype, '') for field in cloud.fields]
    for field, format_ in zip(cloud.fields, formats, strict=True):
        if not format_ or field.offset + int(format_[1]) > cloud.point_step:
            where = f'{field.name[:100]!r} of type {field.datatype} at {field.offset} of {cloud.point_step} bytes'
            raise SceneError(f'the fields of the cloud do not make a layout: {where}')
    try:
        names, offsets = [field.name for field in cloud.fields], [field.offset for field in cloud.fields]
        formats = [order + format_ for format_ in formats]
        return np.dtype({'names': names, 'formats': formats, 'offsets': offsets, 'itemsize': cloud.point_step})
    except (ValueError, TypeError) as error:
        raise SceneError(f'the fields of the cloud do not make a layout ({error})') from error
