"""Recognised things as a point cloud, JSON documents and detections; the message classes are passed in."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from al_questioner.domain import NO_SYMBOL, Candidate, Finding, Recognition
from al_questioner.messages.clouds import POSITION, CloudTypes, cloud_of_points
from al_questioner.messages.stamps import stamp_members

Members = dict[str, Any]

LONGEST_WISH = 1000
"""Characters of what was said that are told again."""


@dataclass(frozen=True)
class DetectionTypes:
    """The message classes of vision_msgs/Detection3DArray and of its poses."""

    array: type[Any]
    detection: Callable[..., Any]
    result: Callable[..., Any]
    hypothesis: Callable[..., Any]
    pose_with_covariance: Callable[..., Any]
    pose: Callable[..., Any]
    point: Callable[..., Any]


def probability_fields(symbols: Sequence[str]) -> tuple[str, ...]:
    """Return the names of the fields that hold the probabilities of the symbols, and as the last that of none.

    Other characters than letters, digits and underscores of ASCII become underscores; what is then no name of its own
    ends in its position among the symbols.

    >>> probability_fields(['main dish', 'main-dish', 'おやつ'])
    ('p_main_dish', 'p_main_dish_1', 'p_2', 'p_none')
    """
    last = f'p_{NO_SYMBOL}'
    names: list[str] = []
    for position, symbol in enumerate(symbols):
        name = re.sub(r'[^0-9A-Za-z_]', '_', f'p_{symbol}').rstrip('_')
        while name in ('p', last, *names):
            name = f'{name}_{position}'
        names.append(name)
    return (*names, last)


def cloud_of_recognition(recognition: Recognition, header: Any, types: CloudTypes) -> Any:
    """Return the `recognised` cloud: one point per thing.

    `x y z object_id` as in `objects`, a float32 field per probability (`probability_fields`), `best`, the position of
    the largest of these, and `known`, 1 if the thing is named.
    """
    things, names = recognition.things, probability_fields(recognition.symbols)
    fields = [*POSITION, ('object_id', 'u4'), *((name, 'f4') for name in names), ('best', 'u4'), ('known', 'u1')]
    # Zeros, so that the padding bytes between the fields are always the same.
    points = np.zeros(len(things), dtype=np.dtype(fields, align=True))
    points['x'], points['y'], points['z'] = np.array([each.position for each in things]).reshape(-1, 3).T
    points['object_id'] = [each.object_id for each in things]
    table = np.array([each.probabilities for each in things]).reshape(-1, len(names))
    for column, name in enumerate(names):
        points[name] = table[:, column]
    points['best'] = [each.probabilities.index(each.probability) for each in things]
    points['known'] = [each.is_known for each in things]
    return cloud_of_points(points, header, types)


def recognition_members(recognition: Recognition, stamp: int, frame_id: str) -> Members:
    """Return the members of a `recognition` document; the stamp, in nanoseconds, and the frame are the scene's."""
    names = (*recognition.symbols, NO_SYMBOL)
    return {
        'stamp': stamp_members(stamp),
        'frame_id': frame_id,
        'symbols': list(recognition.symbols),
        'examples': recognition.examples,
        'threshold': recognition.threshold,
        'things': [
            {
                'object_id': each.object_id,
                'known': each.is_known,
                'best': each.best,
                'probability': each.probability,
                **({'question': each.question} if each.question else {}),
                'position': list(each.position),
                'probabilities': dict(zip(names, each.probabilities, strict=True)),
            }
            for each in recognition.things
        ],
    }


def finding_members(finding: Finding, stamp: int | None = None, frame_id: str = '') -> Members:
    """Return the members of a `target_info` document; stamp (nanoseconds) and frame are of the scene, if any."""
    target = _candidate_members(finding.target) or {'object_id': None, 'probability': None, 'position': None}
    return {
        'text': finding.text,
        'wanted': finding.wanted[:LONGEST_WISH],
        'symbol': finding.symbol,
        **target,
        'runner_up': _candidate_members(finding.runner_up),
        'reason': finding.reason,
        'stamp': None if stamp is None else stamp_members(stamp),
        'frame_id': frame_id,
    }


def detections_of_recognition(recognition: Recognition, header: Any, types: DetectionTypes) -> Any:
    """Return a vision_msgs/Detection3DArray: per thing the probabilities of all symbols, the largest first.

    That of none is left out, as what is missing there up to 1. The id of a detection is that of the thing; its box has
    no size, which nobody has measured.
    """
    detections = []
    for each in recognition.things:
        x, y, z = each.position
        pose = types.pose(position=types.point(x=x, y=y, z=z))
        detection = types.detection(header=header, id=str(each.object_id))
        detection.bbox.center = pose
        pairs = zip(recognition.symbols, each.probabilities, strict=False)
        detection.results = [
            types.result(
                hypothesis=types.hypothesis(class_id=symbol, score=probability),
                pose=types.pose_with_covariance(pose=pose),
            )
            for symbol, probability in sorted(pairs, key=lambda pair: -pair[1])
        ]
        detections.append(detection)
    return types.array(header=header, detections=detections)


def _candidate_members(candidate: Candidate | None) -> Members | None:
    if candidate is None:
        return None
    return {
        'object_id': candidate.object_id,
        'probability': candidate.probability,
        'position': list(candidate.position),
    }
