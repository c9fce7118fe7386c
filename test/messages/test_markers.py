"""People see in RViz and Foxglove what is believed, asked and recognised."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from al_questioner.domain import RecognisedThing, Recognition, Scene
from al_questioner.messages.markers import MarkerTypes, markers, recognised_markers

CONSTANTS = SimpleNamespace(DELETEALL=3, SPHERE=2, CUBE_LIST=6, TEXT_VIEW_FACING=9)


def marker(**members: Any) -> SimpleNamespace:
    return SimpleNamespace(**{'points': [], 'colors': [], 'ns': '', 'text': '', 'action': 0, **members})


TYPES = MarkerTypes(
    SimpleNamespace, marker, SimpleNamespace, SimpleNamespace, SimpleNamespace, SimpleNamespace, CONSTANTS
)
SCENE = Scene((4, 9), np.array([[0, 0, 0.1], [1, 0, 0.3]], np.float32), np.zeros((2, 1), np.float32), ('size_height',))
EMPTY = Scene((), np.empty((0, 3), np.float32), np.empty((0, 1), np.float32), ('size_height',))
BELIEFS = np.array([[0.9, 0.1], [0.2, 0.4]])


def shown(array: Any, namespace: str) -> list[Any]:
    return [each for each in array.markers if each.ns == namespace]


def test_the_pending_question_stands_above_the_things() -> None:
    """A question about no single thing cannot be seen otherwise."""
    array = markers(SCENE, BELIEFS, ('cup', 'jug'), None, 'header', TYPES, 'Can you show me a jug?')
    [question] = shown(array, 'question')
    assert question.text == 'Can you show me a jug?'
    assert question.pose.position.x == 0.5
    assert question.pose.position.z > 0.4
    assert array.markers[0].action == CONSTANTS.DELETEALL
    assert shown(markers(SCENE, BELIEFS, ('cup', 'jug'), None, 'header', TYPES), 'question') == []


def test_a_question_is_shown_where_nothing_is_in_view() -> None:
    array = markers(EMPTY, np.empty((0, 2)), ('cup', 'jug'), None, 'header', TYPES, 'Can you show me a jug?')
    assert [each.text for each in shown(array, 'question')] == ['Can you show me a jug?']


def test_names_stand_above_things_and_tiles_of_their_colour_below() -> None:
    """People see at once what is known, what is not, and what is of none."""
    things = (
        RecognisedThing(4, (0.0, 0.0, 0.1), (0.9, 0.05, 0.05), 'cup'),
        RecognisedThing(9, (1.0, 0.0, 0.3), (0.3, 0.4, 0.3), 'jug', 'What is object 9?'),
        RecognisedThing(5, (2.0, 0.0, 0.3), (0.1, 0.1, 0.8), 'none'),
    )
    array = recognised_markers(Recognition(('cup', 'jug'), 3, 0.5, things), 'header', TYPES)
    assert array.markers[0].action == CONSTANTS.DELETEALL
    assert [each.text for each in shown(array, 'names')] == ['cup 90%', '? jug 40%', 'none 80%']
    assert [each.pose.position.x for each in shown(array, 'names')] == [0.0, 1.0, 2.0]
    [tiles] = shown(array, 'recognised')
    assert [(each.x, each.z) for each in tiles.points] == [(0.0, 0.1), (1.0, 0.3), (2.0, 0.3)]
    colours = [(each.r, each.g, each.b) for each in tiles.colors]
    assert len(set(colours)) == 3
    assert colours[1] == (1.0, 1.0, 1.0)
    opacity = [each.a for each in tiles.colors]
    assert opacity[0] > opacity[2] > opacity[1]


def test_the_names_of_an_empty_table_are_removed() -> None:
    """The last names stay on the screen otherwise."""
    array = recognised_markers(Recognition(('cup', 'jug'), 3, 0.5, ()), 'header', TYPES)
    assert array.markers[0].action == CONSTANTS.DELETEALL
    assert shown(array, 'names') == []
