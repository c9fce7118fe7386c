"""The map and the pictures."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from al_questioner.simulation.kitchen.table_image import Projection
from al_questioner.terminal.capabilities import Capabilities
from al_questioner.terminal.table_map import position_in_words, table_map
from al_questioner.terminal.thumbnail import cut_out, thumbnail


def test_numbers_lie_where_the_objects_lie(made: Any) -> None:
    """Otherwise the person would take the wrong thing in their hand."""
    scene = made.scene_of({1: (0.1, 0.1), 22: (1.3, 0.1), 3: (0.1, 0.7), 4: (0.7, 0.4)})
    lines = [line.plain for line in table_map(scene, 40, 9, None)]
    assert lines[1].startswith('│3 ')
    assert lines[4].index('4') in (19, 20)
    assert lines[7].startswith('│1 ')
    assert lines[7].endswith('22│')


@settings(deadline=None)
@given(st.integers(1, 400), st.integers(12, 90), st.integers(3, 30))
def test_every_number_is_readable_or_counted_as_left_out(made: Any, count: int, columns: int, rows: int) -> None:
    """No number runs into its neighbour and names a third object, and that of the question is not missing."""
    scene = made.many_objects(count)
    lines = [line.plain for line in table_map(scene, columns, rows, 0)]
    assert len(lines) == rows
    assert {len(line) for line in lines} == {columns}
    found = [word.strip('[]') for line in lines[1:-1] for word in line.strip('│').split()]
    assert '[0]' in ' '.join(lines)
    assert len(set(found)) == len(found)
    assert {int(word) for word in found} <= set(range(count))
    if len(found) < count and columns > 20:
        assert f'{count - len(found)} more' in lines[-1]


def test_a_single_object_lies_in_the_middle(made: Any) -> None:
    """Otherwise a table with one thing on it would divide by zero."""
    assert position_in_words(made.scene_of({5: (0.3, 0.2)}), 5) == 'in the middle, at x 0.30 m, y 0.20 m'


def test_an_empty_table_is_an_empty_map(made: Any) -> None:
    """Otherwise a user who teaches would lose the terminal when the table is cleared."""
    lines = [line.plain for line in table_map(made.scene_of({}), 12, 3, None)]
    assert lines == ['┌──────────┐', '│          │', '└──────────┘']


def test_places_are_told_in_words(made: Any) -> None:
    """Metres alone tell a person little."""
    scene = made.scene_of({1: (0.0, 0.0), 2: (1.0, 1.0), 3: (0.5, 1.0), 4: (0.0, 0.5)})
    words = [position_in_words(scene, i).split(',')[0] for i in scene.object_ids]
    assert words == ['front left', 'back right', 'back middle', 'left']


def test_the_part_of_the_picture_that_shows_an_object_is_cut_out(made: Any) -> None:
    """Otherwise the person would be asked about one thing and shown another."""
    scene = made.scene_of({1: (0.2, 0.2), 2: (1.2, 0.6)})
    picture = np.zeros((692, 1280, 3), np.uint8)
    for i, (x, y) in enumerate(((0.2, 0.2), (1.2, 0.6))):
        column, row = Projection().pixel(x, y)
        picture[row - 9 : row + 9, column - 9 : column + 9] = 100 * (i + 1)
    for object_id, brightness in ((1, 100), (2, 200)):
        part = cut_out(picture, scene, object_id)
        middle = part.shape[0] // 2, part.shape[1] // 2
        assert part.max() == brightness
        assert part[middle].max() == brightness


@pytest.mark.parametrize(
    ('size', 'place'), [((480, 640), (0.2, 0.2)), ((692, 1280), (9.0, 0.2)), ((692, 1280), (0.2, -3.0))]
)
def test_nothing_is_cut_out_where_the_place_is_not_known(made: Any, size: Any, place: Any) -> None:
    """Otherwise a camera's picture would be cut at a meaningless place."""
    assert cut_out(made.picture_of(*size), made.scene_of({1: place}), 1) is None
    assert cut_out(made.picture_of(*size), made.scene_of({1: place}), 2) is None


@settings(deadline=None)
@given(st.integers(1, 50), st.integers(1, 50), st.integers(1, 60), st.integers(1, 30), st.booleans())
def test_a_picture_of_any_shape_fits(made: Any, height: int, width: int, columns: int, rows: int, color: bool) -> None:
    """Otherwise an object at the rim of the picture, or a small terminal, would break the screen."""
    lines = thumbnail(
        made.picture_of(height, width), columns, rows, Capabilities(colors='truecolor' if color else None)
    )
    assert 1 <= len(lines) <= rows
    assert {line.cell_len for line in lines} == {len(lines[0].plain)}
    assert len(lines[0].plain) <= columns


def test_bright_and_dark_are_told_apart_without_colours(made: Any) -> None:
    """Otherwise a picture in characters would show nothing."""
    lines = [line.plain for line in thumbnail(made.picture_of(20, 20), 20, 10, Capabilities())]
    assert lines[0][0] == ' '
    assert lines[5][10] == '@'
