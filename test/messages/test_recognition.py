"""Recognised things reach programs and people in every form as they were recognised."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from al_questioner.domain import Candidate, Finding, RecognisedThing, Recognition
from al_questioner.messages import documents
from al_questioner.messages.clouds import CloudTypes
from al_questioner.messages.recognition import (
    LONGEST_WISH,
    DetectionTypes,
    cloud_of_recognition,
    detections_of_recognition,
    finding_members,
    probability_fields,
    recognition_members,
)

SYMBOLS = ('main_dish', 'snack')
THINGS = (
    RecognisedThing(7, (0.25, 0.5, 1.0), (0.125, 0.75, 0.125), 'snack'),
    RecognisedThing(2**32 - 2, (1.0, 2.0, 3.0), (0.25, 0.25, 0.5), 'none'),
    RecognisedThing(3, (0.0, 0.0, 0.0), (0.375, 0.3125, 0.3125), 'main_dish', 'What is object 3?'),
)
FOUND = Recognition(SYMBOLS, 9, 0.5, THINGS)
NOTHING = Recognition(SYMBOLS, 9, 0.5, ())
STAMP = 12_000_000_345
TYPES = CloudTypes(cloud=SimpleNamespace, field=SimpleNamespace, octets=bytes)


def points(cloud: Any) -> np.ndarray:
    """Return the points of a cloud as any reader finds them."""
    formats = {2: 'u1', 6: 'u4', 7: 'f4'}
    layout = np.dtype(
        {
            'names': [field.name for field in cloud.fields],
            'formats': [formats[field.datatype] for field in cloud.fields],
            'offsets': [field.offset for field in cloud.fields],
            'itemsize': cloud.point_step,
        }
    )
    return np.frombuffer(cloud.data, layout)


def test_the_cloud_has_what_was_recognised() -> None:
    """Otherwise a manipulator would see something else than a person."""
    cloud = cloud_of_recognition(FOUND, 'header', TYPES)
    found = points(cloud)
    named = ('p_main_dish', 'p_snack', 'p_none')
    assert found.dtype.names == ('x', 'y', 'z', 'object_id', *named, 'best', 'known')
    assert all(field.offset % 4 == 0 for field in cloud.fields), 'every field lies where C++ expects it'
    assert (cloud.header, cloud.width, cloud.height, cloud.is_dense) == ('header', 3, 1, True)
    assert found['object_id'].tolist() == [7, 2**32 - 2, 3]
    for axis, name in enumerate('xyz'):
        assert found[name].tolist() == [each.position[axis] for each in THINGS]
    for column, name in enumerate(named):
        assert found[name].tolist() == [each.probabilities[column] for each in THINGS]
    assert found['best'].tolist() == [1, 2, 0]
    assert found['known'].tolist() == [1, 1, 0]


def test_an_empty_scene_is_an_empty_cloud() -> None:
    """The last things stay on the screen otherwise."""
    cloud = cloud_of_recognition(NOTHING, 'header', TYPES)
    assert (cloud.width, cloud.data) == (0, b'')
    assert len(cloud.fields) == 9


@pytest.mark.parametrize(
    ('symbols', 'fields'),
    [
        (('snack', 'main dish'), ['p_snack', 'p_main_dish']),
        (('a-b', 'a b', 'a_b'), ['p_a_b', 'p_a_b_1', 'p_a_b_2']),
        (('おやつ', '果物'), ['p_0', 'p_1']),
        (('none!', 'x'), ['p_none_0', 'p_x']),
        (('a b', 'a_b_2', 'a_b'), ['p_a_b', 'p_a_b_2', 'p_a_b_2_2']),
    ],
)
def test_every_field_has_a_valid_name_of_its_own(symbols: tuple[str, ...], fields: list[str]) -> None:
    """A cloud with two fields of one name, or one that C++ cannot name, is read by nobody."""
    assert probability_fields(symbols) == (*fields, 'p_none')


@pytest.mark.parametrize('recognition', [FOUND, NOTHING])
def test_the_document_has_what_was_recognised(recognition: Recognition) -> None:
    text = documents.write('recognition', 'e', recognition_members(recognition, STAMP, 'table'))
    read = documents.read('recognition', text)
    assert (read['frame_id'], read['stamp']) == ('table', {'sec': 12, 'nanosec': 345})
    assert (read['symbols'], read['examples'], read['threshold']) == (list(SYMBOLS), 9, 0.5)
    assert [each['object_id'] for each in read['things']] == [each.object_id for each in recognition.things]
    for told, each in zip(read['things'], recognition.things, strict=True):
        assert list(told['probabilities']) == [*SYMBOLS, 'none']
        assert tuple(told['probabilities'].values()) == each.probabilities
        assert (told['best'], told['probability'], told['known']) == (each.best, each.probability, each.is_known)
        assert told.get('question', '') == each.question
        assert tuple(told['position']) == each.position


TARGET = Candidate(7, (0.25, 0.5, 1.0), 0.75)
OTHER = Candidate(3, (0.0, 0.0, 0.0), 0.3125)


@pytest.mark.parametrize(
    ('finding', 'text'),
    [
        (
            Finding('Snack', 'snack', TARGET, OTHER),
            'Object 7 is snack with a probability of 0.75; next is object 3 with',
        ),
        (Finding('snack', 'snack', TARGET), 'Object 7 is snack with a probability of 0.75; nothing else is in view.'),
        (Finding('snack', 'snack', None, OTHER, 'nothing in view is snack'), 'Nothing in view is snack.'),
        (Finding('x' * 5000, reason='nothing has been taught yet'), 'Nothing has been taught yet.'),
    ],
)
def test_the_answer_to_a_wish_is_a_sentence_and_its_numbers(finding: Finding, text: str) -> None:
    read = documents.read('target_info', documents.write('target_info', 'e', finding_members(finding, STAMP, 'table')))
    assert next(iter(read)) == 'text'
    assert read['text'].startswith(text)
    assert (read['wanted'], read['symbol']) == (finding.wanted[:LONGEST_WISH], finding.symbol)
    assert read['reason'] == finding.reason
    target, other = finding.target, finding.runner_up
    assert read['object_id'] == (target and target.object_id)
    assert read['probability'] == (target and target.probability)
    assert read['position'] == (target and list(target.position))
    assert read['runner_up'] == (
        other and {'object_id': 3, 'probability': other.probability, 'position': list(other.position)}
    )
    assert read['stamp'] == {'sec': 12, 'nanosec': 345}


def test_before_anything_was_seen_an_answer_has_no_time() -> None:
    text = documents.write('target_info', 'e', finding_members(Finding('snack', reason='no objects')))
    assert json.loads(text)['stamp'] is None
    documents.read('target_info', text)


class Made(SimpleNamespace):
    """Any message: its members are what it was made of, and a box."""

    def __init__(self, **members: Any) -> None:
        super().__init__(bbox=SimpleNamespace(), **members)


def test_detections_name_all_symbols_the_most_probable_first() -> None:
    """Other packages take the first hypothesis for the class."""
    types = DetectionTypes(Made, Made, Made, Made, Made, Made, Made)
    array = detections_of_recognition(FOUND, 'header', types)
    assert array.header == 'header'
    assert [each.id for each in array.detections] == ['7', '4294967294', '3']
    for detection, thing in zip(array.detections, THINGS, strict=True):
        told = [(each.hypothesis.class_id, each.hypothesis.score) for each in detection.results]
        assert sorted(told) == sorted(zip(SYMBOLS, thing.probabilities, strict=False))
        assert told[0][1] == max(thing.probabilities[:2])
        for pose in (detection.bbox.center, *(each.pose.pose for each in detection.results)):
            assert (pose.position.x, pose.position.y, pose.position.z) == thing.position
        assert detection.header == 'header'
