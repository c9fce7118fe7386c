"""Scenes and decisions must survive the way through a point cloud, and no cloud may be misread."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from al_questioner.domain import DECISION_FEATURES, Action, Decision, QueryKind, Scene, SceneError
from al_questioner.messages.clouds import (
    CloudTypes,
    cloud_of_decision,
    cloud_of_scene,
    decision_of_cloud,
    scene_of_cloud,
)

TYPES = CloudTypes(cloud=SimpleNamespace, field=SimpleNamespace, octets=bytes)
SYMBOLS = ('fruit', 'snack')
NAMES = ('colour_hue', 'size_height', 'weight_kg')
finite = st.floats(width=32, allow_nan=False, allow_infinity=False)


def make_scene(n: int = 3) -> Scene:
    rng = np.random.default_rng(5)
    return Scene(
        tuple(range(10, 10 + n)),
        rng.normal(size=(n, 3)).astype(np.float32),
        rng.normal(size=(n, len(NAMES))).astype(np.float32),
        NAMES,
    )


def make_cloud(scene: Scene | None = None) -> SimpleNamespace:
    return cloud_of_scene(scene or make_scene(), SimpleNamespace(), TYPES)


def foreign_cloud(points: np.ndarray, width: int, height: int = 1, **members: object) -> SimpleNamespace:
    """A cloud of another make, whose points lie as those of a structured array do."""
    datatypes, layout = {'u1': 2, 'u2': 4, 'i4': 5, 'u4': 6, 'f4': 7, 'f8': 8}, points.dtype
    fields = [
        SimpleNamespace(name=name, offset=offset, datatype=datatypes[kind.str[1:]], count=1)
        for name, (kind, offset) in layout.fields.items()
    ]
    row_step = width * layout.itemsize
    members = {'row_step': row_step, 'is_bigendian': False, 'data': points.tobytes(), **members}
    return SimpleNamespace(fields=fields, width=width, height=height, point_step=layout.itemsize, **members)


@given(hnp.arrays(np.float32, (4, 3), elements=finite), hnp.arrays(np.float32, (4, 2), elements=finite))
def test_scene_survives_to_the_bit(positions: np.ndarray, features: np.ndarray) -> None:
    """Otherwise a learner behind ROS would see other numbers than one offline."""
    scene = Scene((7, 0, 3, 2**31), positions, features, ('a_1', 'b_2'))
    back = scene_of_cloud(make_cloud(scene))
    assert back.object_ids == scene.object_ids
    assert back.feature_names == scene.feature_names
    assert back.features.tobytes() == scene.features.tobytes()
    assert back.positions.tobytes() == scene.positions.tobytes()


def test_layout_is_the_one_the_contract_names() -> None:
    """Otherwise RViz, Foxglove and foreign nodes would not find their fields."""
    cloud = make_cloud()
    assert [field.name for field in cloud.fields] == ['x', 'y', 'z', 'object_id', *NAMES]
    assert [field.datatype for field in cloud.fields] == [7, 7, 7, 6, 7, 7, 7]
    assert [field.offset for field in cloud.fields] == [0, 4, 8, 12, 16, 20, 24]
    assert (cloud.width, cloud.height, cloud.point_step, cloud.row_step) == (3, 1, 28, 84)
    assert len(cloud.data) == 84


@pytest.mark.parametrize('order', ['<', '>'])
def test_foreign_layout_is_read(order: str) -> None:
    """Otherwise a robot's own perception could not publish padded, reordered, two-row, big-endian or float64 clouds."""
    layout = np.dtype(
        {
            'names': ['object_id', 'size_a', 'x', 'y', 'z'],
            'formats': [f'{order}u2', f'{order}f8', f'{order}f4', f'{order}f4', f'{order}f4'],
            'offsets': [0, 8, 16, 20, 24],
            'itemsize': 40,
        }
    )
    points = np.zeros(4, layout)
    points['object_id'], points['size_a'], points['x'] = [4, 5, 6, 7], [0.5, 1.5, 2.5, 3.5], [1, 2, 3, 4]
    rows = points.tobytes()
    data = rows[:80] + b'\xff' * 8 + rows[80:] + b'\xff' * 8
    cloud = foreign_cloud(points, 2, 2, row_step=88, is_bigendian=order == '>', data=data)
    scene = scene_of_cloud(cloud)
    assert scene.object_ids == (4, 5, 6, 7)
    assert scene.features[:, 0].tolist() == [0.5, 1.5, 2.5, 3.5]
    assert scene.positions[:, 0].tolist() == [1, 2, 3, 4]


Damage = Callable[[SimpleNamespace], dict[str, object]]
"""Members of a cloud that are others in a damaged one."""


def field(number: int, **members: object) -> Damage:
    """Alter a field."""

    def alter(cloud: SimpleNamespace) -> dict[str, object]:
        vars(cloud.fields[number]).update(members)
        return {}

    return alter


def octets(offset: int, content: bytes) -> Damage:
    """Alter the data."""
    return lambda cloud: {'data': cloud.data[:offset] + content + cloud.data[offset + len(content) :]}


def _float_id(cloud: SimpleNamespace) -> dict[str, object]:
    return field(3, datatype=7)(cloud) | octets(12, np.float32(1.5).tobytes())(cloud)


@pytest.mark.parametrize(
    ('damage', 'reason'),
    [
        (lambda cloud: {'fields': [each for each in cloud.fields if each.name != 'object_id']}, 'no field object_id'),
        (field(4, count=2), 'more than one value'),
        (field(5, name=NAMES[0]), 'do not make a layout'),
        (field(-1, offset=26), 'do not make a layout'),
        (field(-1, offset=2**31 - 1), 'do not make a layout'),
        (field(-1, datatype=9), 'do not make a layout'),
        (
            lambda cloud: {'width': 2001, 'row_step': 2001 * 28, 'data': bytes(2001 * 28)},
            'has 2001 points, at most 2000',
        ),
        (lambda cloud: {'fields': cloud.fields * 2000}, 'at most 10000'),
        (lambda cloud: {'data': cloud.data[:-1]}, 'too few'),
        (lambda cloud: {'width': 2**31, 'height': 2**31}, 'at most'),
        (lambda cloud: {'point_step': 0, 'row_step': 0, 'fields': []}, 'hold no bytes'),
        (lambda cloud: {'height': 2, 'row_step': 42}, 'too few'),
        (octets(16, np.float32(np.nan).tobytes()), 'colour_hue of object 10 is not finite'),
        (_float_id, 'no uint32'),
        (octets(12, b'\xff' * 4), 'no uint32'),
    ],
)
def test_damaged_cloud_is_refused(damage: Damage, reason: str) -> None:
    """Otherwise the learner would learn from nonsense, or die of it."""
    cloud = make_cloud()
    vars(cloud).update(damage(cloud))
    with pytest.raises(SceneError, match=reason):
        scene_of_cloud(cloud)


EMPTY = {'width': 0, 'row_step': 0, 'data': b''}
WITHOUT_FIELDS = {**EMPTY, 'fields': [], 'point_step': 0}
OF_POSITIONS = {**EMPTY, 'fields': make_cloud().fields[:3]}


@pytest.mark.parametrize('members', [EMPTY, WITHOUT_FIELDS, OF_POSITIONS, {'width': 0}, {'height': 0}])
def test_a_cloud_without_points_shows_that_nothing_is_there(members: dict[str, object]) -> None:
    """Otherwise a table that was cleared would be a fault of the camera, and the last scene stand for it."""
    cloud = make_cloud()
    vars(cloud).update(members)
    scene = scene_of_cloud(cloud, NAMES)
    assert (len(scene), scene.feature_names) == (0, NAMES)
    if 'fields' not in members:
        assert scene_of_cloud(cloud).equals(scene)
        assert scene_of_cloud(cloud_of_scene(scene, None, TYPES)).equals(scene)


@pytest.mark.parametrize(('members', 'reason'), [(WITHOUT_FIELDS, 'neither points'), (OF_POSITIONS, 'no field')])
def test_an_episode_cannot_begin_with_a_cloud_that_tells_no_features(members: dict[str, object], reason: str) -> None:
    """Otherwise the features of the scenes after it would be unknown."""
    cloud = make_cloud()
    vars(cloud).update(members)
    with pytest.raises(SceneError, match=reason):
        scene_of_cloud(cloud)


SIZES = st.sampled_from((0, 1, 3, 12, 28, 84, 200, 2**16, 2**31 - 4, 2**31 - 1, 2**31, 2**32 - 1)) | st.integers(0, 300)
"""Around the sizes that fit, and where numbers of 32 bits end."""
FIELDS = st.lists(
    st.builds(
        SimpleNamespace,
        name=st.sampled_from(('x', 'y', 'z', 'object_id', *NAMES)) | st.text(max_size=5),
        offset=SIZES,
        datatype=st.integers(0, 9),
        count=st.sampled_from((1, 1, 1, 0, 2, 2**32 - 1)),
    ),
    max_size=9,
)
CLOUDS = st.fixed_dictionaries(
    {},
    optional={
        'data': st.binary(max_size=300),
        'width': SIZES,
        'height': SIZES,
        'point_step': SIZES,
        'row_step': SIZES,
        'fields': FIELDS,
        'is_bigendian': st.booleans(),
    },
)


@settings(max_examples=400)
@given(CLOUDS, st.booleans())
def test_no_cloud_does_more_than_be_refused(damage: dict[str, object], is_scene: bool) -> None:
    """Garbage on the topic, or in a bag, does not end the process, and nothing beyond the data is read."""
    cloud = make_cloud() if is_scene else cloud_of_decision(make_decision(), SYMBOLS, None, TYPES)
    vars(cloud).update(damage)
    try:
        scene = scene_of_cloud(cloud) if is_scene else decision_of_cloud(cloud, SYMBOLS, 4)
    except SceneError:
        return
    if isinstance(scene, Scene):
        assert len(scene) == cloud.width * cloud.height
        assert len(cloud.data) >= len(scene) * cloud.point_step


def make_decision() -> Decision:
    rng = np.random.default_rng(2)
    return Decision(
        turn=4,
        candidates=(
            Action(QueryKind.DEMONSTRATION, symbol='snack'),
            Action(QueryKind.LABEL, object_id=0),
            Action(QueryKind.FEATURE_SUBSET),
            Action(QueryKind.NO_QUERY),
        ),
        features=rng.random((4, 7)),
        utilities=np.array([0.1, np.nan, -3.0, 1 / 3]),
        chosen=3,
        query=None,
    )


def test_decision_survives_to_the_bit() -> None:
    """Otherwise a bag would hold other utilities than those the learner decided by."""
    decision = make_decision()
    back = decision_of_cloud(cloud_of_decision(decision, SYMBOLS, None, TYPES), SYMBOLS, 4)
    assert back.candidates == decision.candidates
    assert back.features.tobytes() == decision.features.tobytes()
    assert back.utilities.tobytes() == decision.utilities.tobytes()
    assert (back.chosen, back.turn) == (3, 4)


def test_the_candidates_of_a_decision_lie_where_their_objects_do() -> None:
    """RViz and Foxglove draw no cloud without x, y, z, and read values where their type is aligned."""
    scene = Scene((7, 0), np.float32([[1, 2, 3], [4, 5, 6]]), np.zeros((2, 1), np.float32), ('a_1',))
    cloud = cloud_of_decision(make_decision(), SYMBOLS, None, TYPES, scene)
    assert [(field.name, field.offset, field.datatype) for field in cloud.fields[:7]] == [
        *(('x', 0, 7), ('y', 4, 7), ('z', 8, 7)),
        *(('kind', 12, 2), ('chosen', 13, 2), ('object_id', 16, 6), ('symbol', 20, 5)),
    ]
    sizes = {2: 1, 5: 4, 6: 4, 7: 4, 8: 8}
    assert all(field.offset % sizes[field.datatype] == 0 for field in cloud.fields)
    assert (cloud.point_step, cloud.row_step, len(cloud.data)) == (88, 4 * 88, 4 * 88)
    assert cloud.is_dense is False
    points = np.frombuffer(cloud.data, np.uint8).reshape(4, 88)[:, :12].copy().view(np.float32)
    np.testing.assert_array_equal(points, [[np.nan] * 3, [4, 5, 6], [np.nan] * 3, [np.nan] * 3])
    assert make_cloud().is_dense is True


def test_decisions_of_earlier_recordings_are_read() -> None:
    """Every older bag, the shipped ones among them, is packed and without positions."""
    decision, features = make_decision(), [(name, '<f8') for name in DECISION_FEATURES]
    layout = np.dtype(
        [('kind', 'u1'), ('object_id', '<u4'), ('symbol', '<i4'), *features, ('utility', '<f8'), ('chosen', 'u1')]
    )
    points = np.zeros(4, layout)
    points['kind'], points['symbol'] = [1, 0, 2, 3], [1, -1, -1, -1]
    points['object_id'] = [2**32 - 1, 0, 2**32 - 1, 2**32 - 1]
    for column, name in enumerate(DECISION_FEATURES):
        points[name] = decision.features[:, column]
    points['utility'], points['chosen'][3] = decision.utilities, 1
    cloud = foreign_cloud(points, 4)
    back = decision_of_cloud(cloud, SYMBOLS, 4)
    assert back.candidates == decision.candidates
    assert back.utilities.tobytes() == decision.utilities.tobytes()


def test_decision_without_one_choice_is_refused() -> None:
    """Otherwise a demonstration with no choice, or two, would be imitated."""
    cloud = cloud_of_decision(make_decision(), SYMBOLS, None, TYPES)
    field = next(field for field in cloud.fields if field.name == 'chosen')
    chosen = 3 * cloud.point_step + field.offset
    cloud.data = cloud.data[:chosen] + b'\0' + cloud.data[chosen + 1 :]
    with pytest.raises(SceneError, match='marks 0 candidates'):
        decision_of_cloud(cloud, SYMBOLS, 4)


def test_scene_cloud_is_no_decision() -> None:
    """Otherwise remapped topics would be read as decisions."""
    with pytest.raises(SceneError, match='no field kind'):
        decision_of_cloud(make_cloud(), SYMBOLS, 1)


def test_decision_of_other_symbols_is_refused() -> None:
    """Otherwise a decision would be read with the symbols of another episode."""
    cloud = cloud_of_decision(make_decision(), SYMBOLS, None, TYPES)
    with pytest.raises(SceneError, match='does not exist'):
        decision_of_cloud(cloud, ('fruit',), 4)


def test_the_kind_of_a_relevance_query_has_the_last_number() -> None:
    """Recordings hold the numbers, so that those of the other kinds stay."""
    actions = tuple(map(Action, QueryKind))
    nothing = np.full((len(actions), len(DECISION_FEATURES)), np.nan)
    decision = Decision(1, actions, nothing, np.zeros(len(actions)), 4, None)
    cloud = cloud_of_decision(decision, SYMBOLS, SimpleNamespace(), TYPES)
    kinds = [cloud.data[row * cloud.point_step + 12] for row in range(len(actions))]
    assert dict(zip((action.kind.value for action in actions), kinds, strict=True)) == {
        'label': 0, 'demonstration': 1, 'feature_subset': 2, 'no_query': 3, 'relevance': 4,
    }  # fmt: skip
    back = decision_of_cloud(cloud, SYMBOLS, 1)
    assert back.candidates[back.chosen] == Action(QueryKind.RELEVANCE)
