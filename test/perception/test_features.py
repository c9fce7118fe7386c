"""The features of hand-made views with known answers, and what must not change them."""

from __future__ import annotations

import dataclasses

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray

from al_questioner.domain import Camera, InputError, View, group_of
from al_questioner.perception import VIEW_FEATURE_NAMES, view_features
from al_questioner.perception.features import NOMINAL_DISTANCE

CAMERA = Camera(fx=525.0, fy=525.0, cx=319.5, cy=239.5)
RED, GREY, WHITE = (0, 0, 255), (120, 120, 120), (255, 255, 255)
HUES = ('red', 'yellow', 'green', 'cyan', 'blue', 'magenta')
METRIC = ('size_length', 'size_width', 'size_area')


def make_view(
    mask: NDArray[np.bool_],
    color: NDArray[np.uint8] | tuple[int, int, int] = GREY,
    distance: float = 0.7,
    camera: Camera = CAMERA,
) -> View:
    """A view of a flat object that faces the camera, before a white wall at 1.5 m."""
    image = np.full((*mask.shape, 3), WHITE, dtype=np.uint8)
    image[mask] = color if isinstance(color, tuple) else color[mask]
    depth = np.where(mask, round(distance * 1000), 1500).astype(np.uint16)
    return View(image, depth, mask, camera, origin=(200, 150))


def rectangle(height: int, width: int, border: int = 8) -> NDArray[np.bool_]:
    mask = np.zeros((height + 2 * border, width + 2 * border), dtype=bool)
    mask[border : border + height, border : border + width] = True
    return mask


def disc(radius: int) -> NDArray[np.bool_]:
    rows, columns = np.indices((2 * radius + 11, 2 * radius + 11)) - (radius + 5)
    return rows**2 + columns**2 <= radius**2


def measure(view: View) -> dict[str, float]:
    return dict(zip(VIEW_FEATURE_NAMES, view_features(view).tolist(), strict=True))


def of_group(features: dict[str, float], *groups: str) -> dict[str, float]:
    return {name: value for name, value in features.items() if group_of(name) in groups}


def noise(shape: tuple[int, int], seed: int = 0) -> NDArray[np.uint8]:
    coarse = np.random.default_rng(seed).integers(0, 256, (shape[0] // 8 + 1, shape[1] // 8 + 1, 3), dtype=np.uint8)
    return cv2.resize(coarse, (shape[1], shape[0]), interpolation=cv2.INTER_NEAREST)


def test_names_are_distinct_and_start_with_a_group_that_people_name() -> None:
    assert len(set(VIEW_FEATURE_NAMES)) == len(VIEW_FEATURE_NAMES)
    assert {group_of(name) for name in VIEW_FEATURE_NAMES} == {'colour', 'size', 'shape', 'texture'}


def test_square_of_six_centimetres_measures_six_centimetres() -> None:
    """45 pixels at 0.7 m with a focal length of 525 pixels are 0.06 m."""
    features = measure(make_view(rectangle(45, 45), RED))
    assert features['size_length'] == pytest.approx(0.06, rel=1e-5)
    assert features['size_width'] == pytest.approx(0.06, rel=1e-5)
    assert features['size_area'] == pytest.approx(0.0036, rel=1e-5)
    assert features['size_depth'] == 0


def test_focal_lengths_of_both_axes_are_used() -> None:
    features = measure(make_view(rectangle(height=40, width=40), camera=Camera(400.0, 800.0, 0.0, 0.0), distance=1.0))
    assert features['size_length'] == pytest.approx(0.1, rel=1e-5)
    assert features['size_width'] == pytest.approx(0.05, rel=1e-5)


def test_size_does_not_depend_on_how_the_object_lies() -> None:
    """The corners of slanted edges' pixels stick out by sqrt(1/2) pixel at most, at both ends."""
    rows, columns = np.indices((200, 200)) - 99.5
    cosine, sine = np.cos(0.6), np.sin(0.6)
    slanted = (abs(columns * cosine + rows * sine) < 60) & (abs(rows * cosine - columns * sine) < 30)
    upright, turned = measure(make_view(rectangle(120, 60))), measure(make_view(slanted))
    pixel = 0.7 / 525
    assert turned['size_length'] == pytest.approx(upright['size_length'], abs=1.5 * pixel)
    assert turned['size_width'] == pytest.approx(upright['size_width'], abs=1.5 * pixel)
    assert turned['size_area'] == pytest.approx(upright['size_area'], rel=0.005)
    for name in ('shape_aspect', 'shape_circularity', 'shape_hu_1'):
        assert turned[name] == pytest.approx(upright[name], abs=0.02), name


def test_extent_in_depth_ignores_stray_readings() -> None:
    view = make_view(rectangle(50, 50))
    depth = view.depth.copy()
    depth[8:58, 8:58] = np.linspace(600, 700, 50).round()[None, :]
    depth[10, 10:40] = 4000
    features = measure(dataclasses.replace(view, depth=depth))
    assert features['size_depth'] == pytest.approx(0.09, abs=0.004)
    assert features['size_length'] == pytest.approx(50 * 0.65 / 525, rel=0.01)


def test_disc_is_round_and_square_is_less_so() -> None:
    """The hull goes round whole pixels: it is wider than the disc by sqrt(1/2) pixel at most."""
    round_thing, square = measure(make_view(disc(40))), measure(make_view(rectangle(80, 80)))
    assert (40 / (40 + np.sqrt(0.5))) ** 2 < round_thing['shape_circularity'] < 1
    assert square['shape_circularity'] == pytest.approx(np.pi / 4, rel=1e-5)
    assert round_thing['shape_extent'] == pytest.approx(np.pi / 4, abs=0.02)
    assert square['shape_extent'] == pytest.approx(1.0, rel=1e-5)
    assert round_thing['shape_hu_1'] == pytest.approx(np.log10(1 / (2 * np.pi)), abs=0.01)
    assert square['shape_hu_1'] == pytest.approx(np.log10(1 / 6), abs=0.01)


def test_solidity_tells_a_cross_from_its_hull() -> None:
    """A plus sign with arms of a third of its width covers 5/9 of its square, and its hull 7/9."""
    mask = np.zeros((70, 70), dtype=bool)
    mask[5:65, 25:45] = mask[25:45, 5:65] = True
    features = measure(make_view(mask))
    assert features['shape_solidity'] == pytest.approx(5 / 7, rel=1e-5)
    assert features['shape_aspect'] == pytest.approx(1.0, rel=0.02)


@pytest.mark.parametrize(
    ('bgr', 'hues'),
    [
        ((0, 0, 255), {'red': 1.0}),
        ((0, 255, 255), {'yellow': 1.0}),
        ((0, 255, 0), {'green': 1.0}),
        ((255, 255, 0), {'cyan': 1.0}),
        ((255, 0, 0), {'blue': 1.0}),
        ((255, 0, 255), {'magenta': 1.0}),
        ((0, 128, 255), {'red': 0.5, 'yellow': 0.5}),
        (GREY, {}),
        ((0, 0, 0), {}),
    ],
)
def test_hue_is_shared_between_the_two_nearest_and_a_grey_thing_has_none(
    bgr: tuple[int, int, int], hues: dict[str, float]
) -> None:
    features = measure(make_view(rectangle(30, 30), bgr))
    for name in HUES:
        assert features[f'colour_{name}'] == pytest.approx(hues.get(name, 0.0), abs=0.02), name


def test_lab_of_white_and_red() -> None:
    """CIE L*a*b* of sRGB white is (100, 0, 0) and of red (53.2, 80.1, 67.2)."""
    white, red = measure(make_view(rectangle(30, 30), WHITE)), measure(make_view(rectangle(30, 30), RED))
    assert white['colour_lightness'] == pytest.approx(1.0, abs=0.01)
    assert red['colour_lightness'] == pytest.approx(0.532, abs=0.01)
    assert red['colour_green_red'] == pytest.approx(80.1 / 255, abs=0.01)
    assert red['colour_blue_yellow'] == pytest.approx(67.2 / 255, abs=0.01)
    assert red['colour_lightness_spread'] == red['colour_saturation_spread'] == 0


def test_uniform_thing_has_no_texture_and_a_checkerboard_has() -> None:
    mask = rectangle(48, 48)
    board = np.where(np.indices(mask.shape).sum(axis=0) % 2, 255, 0).astype(np.uint8)[..., None].repeat(3, axis=2)
    plain, checked = measure(make_view(mask)), measure(make_view(mask, board))
    assert set(of_group(plain, 'texture').values()) == {0.0}
    assert checked['texture_entropy'] == pytest.approx(1.0, abs=0.01)
    assert checked['texture_fine'] == pytest.approx(0.5, rel=0.1)
    assert checked['texture_coarse'] < 0.05


def test_fine_and_coarse_bands_tell_the_scale_of_a_pattern() -> None:
    mask = rectangle(60, 60)
    rows, columns = np.indices(mask.shape)
    features = {}
    for square in (1, 10):
        board = np.where((rows // square + columns // square) % 2, 255, 0).astype(np.uint8)
        features[square] = measure(make_view(mask, board[..., None].repeat(3, axis=2)))
    assert features[1]['texture_fine'] > features[10]['texture_fine']
    assert features[1]['texture_coarse'] < features[10]['texture_coarse']


def test_what_lies_behind_the_object_changes_nothing() -> None:
    view = make_view(disc(45), noise((101, 101)))
    behind = view.color.copy()
    behind[~view.mask] = np.random.default_rng(1).integers(0, 256, (np.count_nonzero(~view.mask), 3))
    depth = np.where(view.mask, view.depth, 300).astype(np.uint16)
    assert np.array_equal(view_features(dataclasses.replace(view, color=behind, depth=depth)), view_features(view))


def test_place_in_the_frame_and_margin_of_the_crop_change_nothing() -> None:
    view = make_view(disc(45), noise((101, 101)))
    margin = ((3, 20), (17, 0))
    depth, mask = np.pad(view.depth, margin), np.pad(view.mask, margin)
    wide = View(np.pad(view.color, (*margin, (0, 0))), depth, mask, CAMERA, origin=(10, 400))
    assert np.array_equal(view_features(wide), view_features(view))


def test_doubled_resolution_leaves_size_shape_and_colour() -> None:
    mask = rectangle(90, 60)
    view = make_view(mask, noise(mask.shape))
    parts = (part.repeat(2, 0).repeat(2, 1) for part in (view.color, view.depth, view.mask))
    double = View(*parts, Camera(1050.0, 1050.0, 639.5, 479.5), origin=(400, 300))
    before, after = measure(view), measure(double)
    for name in METRIC:
        assert after[name] == pytest.approx(before[name], rel=0.02), name
    for name, value in of_group(before, 'shape', 'colour').items():
        assert after[name] == pytest.approx(value, abs=0.02), name


def test_mirrored_image_keeps_colour_and_texture() -> None:
    view = make_view(disc(45), noise((101, 101)))
    mirrored = View(view.color[:, ::-1], view.depth[:, ::-1], view.mask[:, ::-1], CAMERA, view.origin)
    before, after = measure(view), measure(mirrored)
    for name, value in before.items():
        assert after[name] == pytest.approx(value, rel=0.01, abs=1e-4), name


def test_without_depth_the_object_is_taken_to_stand_at_the_nominal_distance() -> None:
    view = make_view(rectangle(45, 45), RED, distance=NOMINAL_DISTANCE)
    blind = dataclasses.replace(view, depth=np.zeros_like(view.depth))
    assert np.array_equal(view_features(blind), view_features(view))


def test_depth_with_holes_gives_almost_the_same_size() -> None:
    view = make_view(rectangle(45, 45))
    holes = np.random.default_rng(2).random(view.depth.shape) < 0.7
    features, whole = measure(dataclasses.replace(view, depth=np.where(holes, 0, view.depth))), measure(view)
    assert of_group(features, 'size') == of_group(whole, 'size')


def test_occluded_object_in_two_parts_is_measured_as_one() -> None:
    mask = rectangle(90, 60)
    mask[40:55] = False
    features = measure(make_view(mask))
    assert features['size_length'] == pytest.approx(0.12, rel=1e-5)
    assert features['shape_solidity'] == pytest.approx(75 / 90, rel=1e-5)


@pytest.mark.parametrize('shape', [(1, 1), (1, 400), (400, 1), (2, 3)])
def test_tiny_and_thin_objects_have_finite_features(shape: tuple[int, int]) -> None:
    assert np.isfinite(view_features(make_view(rectangle(*shape)))).all()


WHOLE = make_view(rectangle(20, 20))


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'mask': np.zeros_like(WHOLE.mask)}, 'the mask is empty'),
        *(({part: getattr(WHOLE, part)[:-1]}, 'must be') for part in ('color', 'depth', 'mask')),
        ({'color': WHOLE.color / 255.0}, 'must be uint8, not float64'),
        *(({'camera': Camera(525, fy, 0, 0)}, 'the focal length fy') for fy in (0.0, -525.0, float('nan'))),
    ],
)
def test_what_is_no_view_is_refused(changes: dict[str, object], reason: str) -> None:
    with pytest.raises(InputError, match=reason):
        view_features(dataclasses.replace(WHOLE, **changes))


@st.composite
def views(draw: st.DrawFn) -> View:
    shape = (draw(st.integers(1, 90)), draw(st.integers(1, 90)))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    mask = rng.random(shape) < draw(st.sampled_from([0.001, 0.1, 0.5, 1.0]))
    mask[draw(st.integers(0, shape[0] - 1)), draw(st.integers(0, shape[1] - 1))] = True
    color = draw(arrays(np.uint8, (1, 1, 3))) + rng.integers(0, draw(st.integers(1, 256)), (*shape, 3))
    depth = np.where(rng.random(shape) < draw(st.sampled_from([0.0, 0.5, 1.0])), rng.integers(0, 65536, shape), 0)
    return View(color.astype(np.uint8), depth.astype(np.uint16), mask, CAMERA, (0, 0))


@settings(max_examples=80, deadline=None, derandomize=True)
@given(views())
def test_any_view_gives_a_finite_vector_within_its_bounds(view: View) -> None:
    vector, features = view_features(view), measure(view)
    assert vector.dtype == np.float32
    assert np.isfinite(vector).all()
    assert sum(features[f'colour_{hue}'] for hue in HUES) < 1.01
    for name in ('shape_aspect', 'shape_solidity', 'shape_extent', 'shape_circularity', 'texture_edges'):
        assert 0 <= features[name] <= 1.001, name
    assert 0 <= features['texture_entropy'] <= 5
    assert min(of_group(features, 'size').values()) >= 0


def test_where_in_memory_a_view_is_measured_does_not_matter() -> None:
    """Otherwise an episode could not be repeated: the same view would now and then be measured differently."""
    # Of 4000 such grains, the one with a pixel at the threshold of an edge on which cv2.magnitude is of two minds.
    rng = np.random.default_rng(1237)
    grain = np.full((79, 63, 1), 120, dtype=np.uint8)
    grain[8:-8, 8:-8] = rng.normal(120, 17, (63, 47, 1)).astype(np.uint8)
    view = make_view(rectangle(63, 47), np.repeat(grain, 3, axis=2))
    lumber, seen = [], set()
    for _ in range(100):
        lumber.append(np.empty(rng.integers(1, 5000), dtype=np.uint8))
        seen.add(view_features(view).tobytes())
    assert len(seen) == 1
