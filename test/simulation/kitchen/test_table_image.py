"""The picture of the table."""

from __future__ import annotations

import numpy as np
import pytest

from al_questioner.domain import Camera, Observation, View
from al_questioner.simulation import SimulatedWorld, Task
from al_questioner.simulation.kitchen.table_image import Mark, draw_scene

RED = (220, 30, 30)


def flat_view(rows: int, columns: int, depth: int, masked: bool = True) -> View:
    """A crop of one green surface, like a real one without any table around it."""
    color = np.zeros((rows, columns, 3), dtype=np.uint8)
    color[:] = (0, 200, 0)
    mask = np.full((rows, columns), masked)
    return View(color, np.full((rows, columns), depth, dtype=np.uint16), mask, Camera(525, 525, 319.5, 239.5), (0, 0))


def thing(object_id: int = 1, x: float = 0.7, y: float = 0.4, view: View | None = None) -> Observation:
    return Observation(object_id, (x, y, 0.0), view or flat_view(60, 60, 800), {})


def test_every_object_is_drawn_where_it_stands(small: Task) -> None:
    scene = SimulatedWorld(small, 1).scene(1)
    empty, full = draw_scene([]).image, draw_scene(scene)
    assert full.image.dtype == np.uint8
    assert full.image.shape == empty.shape
    for o in scene:
        column, row = full.pixels[o.object_id]
        window = np.s_[max(row - 15, 0) : row + 15, max(column - 15, 0) : column + 15]
        assert (full.image[window] != empty[window]).any()
    by_x = sorted(scene, key=lambda o: o.position[0])
    assert [full.pixels[o.object_id][0] for o in by_x] == sorted(p[0] for p in full.pixels.values())


def test_marks_are_seen_and_only_where_asked(small: Task) -> None:
    scene = SimulatedWorld(small, 1).scene(1)
    plain = draw_scene(scene)
    marked = draw_scene(scene, {scene[2].object_id: Mark(RED, 'snack')})
    rows, columns = np.nonzero((plain.image != marked.image).any(axis=2))
    column, row = plain.pixels[scene[2].object_id]
    assert (marked.image == RED).all(axis=2).sum() > 100
    assert np.hypot(columns - column, rows - row).max() < 220


@pytest.mark.parametrize('position', [(0.0, 0.0, 0.0), (1.4, 0.8, 0.0), (-3.0, 9.0, 0.0)])
@pytest.mark.parametrize('view', [flat_view(60, 40, 800), flat_view(300, 400, 0), flat_view(9, 9, 700, masked=False)])
def test_any_view_anywhere_can_be_drawn(position: tuple[float, float, float], view: View) -> None:
    """Real crops: no margin, no depth at all, an empty mask; and things at or beyond the table's edge."""
    image = draw_scene([Observation(3, position, view, {})], {3: Mark(RED, 'a rather long label')}).image
    assert image.ndim == 3


def test_things_are_drawn_to_scale() -> None:
    """100 pixels at 1.05 m and 525 pixels focal length are 20 cm, whatever the camera's distance."""
    widths = []
    for columns, depth in ((100, 1050), (200, 525)):
        image = draw_scene([thing(view=flat_view(columns // 2, columns, depth))]).image.astype(int)
        green = (image[..., 1] > 150) & (image[..., 0] < 80) & (image[..., 2] < 80)
        widths.append(np.ptp(np.flatnonzero(green.any(axis=0))))
    assert widths[0] == pytest.approx(0.2 * 1280 / 1.68, abs=4)
    assert widths[1] == pytest.approx(widths[0], abs=2)


def test_a_line_leads_from_a_number_to_a_thing_that_lies_aslant() -> None:
    """Otherwise in clutter, the number of a spoon would seem to belong to what lies beside it."""
    lengths = []
    for view in (flat_view(100, 100, 800), flat_view(100, 100, 800)):
        if lengths:
            # What is left of the square is its lower right corner.
            view.mask[:] = np.add.outer(np.arange(100), np.arange(100)) > 150
            view.mask[-1] = view.mask[:, -1] = True
        image = draw_scene([thing(view=view)]).image.astype(int)
        lengths.append(((image.min(axis=2) > 220) & (np.ptp(image, axis=2) < 10)).sum())
    assert lengths[1] > lengths[0] + 40


def test_the_picture_does_not_depend_on_the_order_of_the_scene(small: Task) -> None:
    scene = SimulatedWorld(small, 1).scene(1)
    assert (draw_scene(scene).image == draw_scene(scene[::-1]).image).all()


def test_a_wide_picture_is_wide(small: Task) -> None:
    assert draw_scene(SimulatedWorld(small, 1).scene(1)[:1], width_px=400).image.shape[1] == 400


def test_the_text_of_a_mark_hides_no_number() -> None:
    """Otherwise an answer would cover the number of what stands before the thing that it is about."""
    # Its number begins where the text would be; the second one's, where the text would be above.
    before, behind = thing(22, 0.75, 0.25), thing(33, 0.73, 0.44)
    for scene in ([thing(), before], [thing(), before, behind]):
        unmarked, ringed = draw_scene(scene).image, draw_scene(scene, {1: Mark(RED)}).image
        marked = draw_scene(scene, {1: Mark(RED, 'snack')}).image
        changed = (marked != ringed).any(axis=2)
        assert changed.sum() > 500
        # The plates of other things are nearly white, and nothing else here is.
        assert (unmarked.min(axis=2) == 250).sum() > 300
        assert not (changed & (unmarked.min(axis=2) == 250)).any()


def test_a_text_with_numbers_all_around_is_below() -> None:
    """Otherwise it would be missing where things stand close together."""
    places = [(float(x), float(y)) for x in np.arange(0.55, 0.9, 0.03) for y in np.arange(0.2, 0.6, 0.04)]
    scene = [thing(), *(thing(10 + i, *place) for i, place in enumerate(places))]
    changed = draw_scene(scene, {1: Mark(RED, 'snack')}).image != draw_scene(scene, {1: Mark(RED)}).image
    rows, columns = np.nonzero(changed.any(axis=2))
    column, row = draw_scene(scene).pixels[1]
    assert rows.min() > row
    assert abs(columns.mean() - column) < 10
