"""Knowledge as members of a JSON document, with numbers that people can read and that keep every bit."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from datetime import datetime, timezone
from functools import lru_cache
from typing import Any

import numpy as np

from al_questioner.domain import (
    Classifiers,
    Hearsay,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    QueryKind,
    SeenView,
    Statistics,
    TeacherCounts,
    ViewJudgement,
    ViewLabel,
)
from al_questioner.messages.stamps import SECOND

Members = dict[str, Any]

VIEWS_KEPT = 4096
"""Views whose numbers are not written a second time: a learner writes all that it knows after each answer."""


def knowledge_members(knowledge: Knowledge) -> Members:
    """Return the members of a `concepts` document, those that follow from others included."""
    classifiers, statistics = knowledge.classifiers, knowledge.statistics
    members: Members = {
        'symbols': list(knowledge.symbols),
        'examples': knowledge.counts,
        'relevant_groups': list(knowledge.relevant_groups) or None,
        'groups': list(knowledge.groups),
        'feature_names': list(knowledge.feature_names),
        'kernel': {**classifiers._asdict(), 'length_scale': knowledge.length_scale},
    }
    if knowledge.selection:
        members['feature_selection'] = knowledge.selection
    if statistics is not None:
        members['standardisation'] = {
            'count': statistics.count,
            'mean': list(statistics.mean),
            'scale': list(statistics.scale),
        }
        members['features_in_use'] = list(statistics.features_in_use)
    reliable = knowledge.reliabilities
    return {
        **members,
        'teachers': {
            name: {**vars(counts), **({'reliability': reliable[name]} if name in reliable else {})}
            for name, counts in knowledge.teachers.items()
        },
        'episodes': [_origin_members(origin) for origin in knowledge.origins],
        'lessons': [_lesson_members(lesson) for lesson in knowledge.lessons],
    }


def knowledge_of(members: Mapping[str, Any]) -> Knowledge:
    """Return the knowledge that the members of a checked document tell of.

    Raises:
        InputError: parts that do not fit each other, or a number that is no float32.
    """
    kernel = members['kernel']
    length_scale = kernel['length_scale']
    standardisation = members.get('standardisation')
    statistics = None
    if standardisation is not None:
        statistics = Statistics(
            standardisation['count'],
            tuple(_number(each, 'a mean') for each in standardisation['mean']),
            tuple(_number(each, 'a scale') for each in standardisation['scale']),
            tuple(members.get('features_in_use', members['feature_names'])),
        )
    return Knowledge(
        symbols=tuple(members['symbols']),
        feature_names=tuple(members['feature_names']),
        classifiers=Classifiers(
            _number(kernel['amplitude'], 'the amplitude'),
            kernel['kernel_shape'],
            _number(kernel['class_balance'], 'the class balance'),
        ),
        length_scale=None if length_scale is None else _number(length_scale, 'the length scale'),
        selection=members.get('feature_selection', ''),
        lessons=tuple(map(_lesson_of, members['lessons'])),
        origins=tuple(map(_origin_of, members['episodes'])),
        reliabilities={
            name: counts['reliability']
            for name, counts in members.get('teachers', {}).items()
            if 'reliability' in counts
        },
        statistics=statistics,
    )


def readable(numbers: Iterable[float]) -> list[float]:
    """Return float32 numbers as the shortest decimals that read back as the same float32."""
    return list(_readable(np.array(tuple(numbers), dtype='<f4').tobytes()))


@lru_cache(maxsize=VIEWS_KEPT)
def _readable(bits: bytes) -> tuple[float, ...]:
    singles = np.frombuffer(bits, dtype='<f4')
    short = singles.astype(str).astype(np.float64)
    # Read as float64 first, a decimal could in principle fall on the wrong side of the middle of two float32.
    is_exact = short.astype(np.float32) == singles
    return tuple(float(number) for number in np.where(is_exact, short, singles.astype(np.float64)))


def forget_written() -> None:
    """Forget which views were written already, to measure how long that takes."""
    _readable.cache_clear()


def exact(numbers: object, what: str) -> tuple[float, ...]:
    """Return the float32 numbers that decimals stand for.

    Raises:
        InputError: no list of finite numbers within the range of float32; the text calls it `what`.
    """
    try:
        table = np.asarray(numbers)
        with np.errstate(over='ignore'):
            found = table.astype(np.float32)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f'{what} are not numbers') from None
    if table.ndim != 1 or (table.size and table.dtype.kind not in 'iuf'):
        raise InputError(f'{what} are not numbers')
    if not np.isfinite(found).all():
        raise InputError(f'{what} are not all finite numbers of 32 bits')
    return tuple(found.tolist())


def _number(value: float, what: str) -> float:
    """Return a number of a document as a float.

    Raises:
        InputError: it is too large.
    """
    try:
        found = float(value)
    except OverflowError:
        found = math.inf
    if not math.isfinite(found):
        raise InputError(f'{what} is too large a number')
    return found


def time_text(stamp: int) -> str:
    """Return a time in nanoseconds since the epoch as ISO 8601 in UTC, with all its digits."""
    seconds, rest = divmod(stamp, SECOND)
    whole = datetime.fromtimestamp(seconds, timezone.utc).replace(tzinfo=None)
    return f'{whole.isoformat(timespec="seconds")}.{rest:09d}Z'


def time_of(text: str) -> int:
    """Return the nanoseconds of a time, as the inverse of `time_text`.

    Raises:
        InputError: it is not written like that.
    """
    whole, _, rest = text.removesuffix('Z').partition('.')
    try:
        seconds = datetime.strptime(whole, '%Y-%m-%dT%H:%M:%S').replace(tzinfo=timezone.utc).timestamp()
        return round(seconds) * SECOND + int(f'{rest:0<9.9}')
    except ValueError:
        raise InputError(f'{text[:40]!r} is not a time such as 2026-11-28T16:40:12.5Z') from None


def _lesson_members(lesson: Lesson) -> Members:
    told = {
        'time': None if lesson.stamp is None else time_text(lesson.stamp),
        'kind': None if lesson.kind is None else lesson.kind.value,
        'teacher': lesson.teacher,
        'labels': [_label_members(label) for label in lesson.labels],
        'judgements': [dict(vars(each)) for each in lesson.judgements],
        'withdrawn': list(lesson.withdrawn),
        'groups': list(lesson.groups),
        'unnameable': list(lesson.unnameable),
        'hearsay': [dict(vars(said)) for said in lesson.hearsay],
        'seen': [
            {'view': view.number, 'object': view.object_id, 'features': readable(view.features)} for view in lesson.seen
        ],
    }
    return {'episode': lesson.episode, 'turn': lesson.turn, **{name: each for name, each in told.items() if each}}


def _label_members(label: ViewLabel) -> Members:
    how = {'left_out': label.left_out or None, 'carried_from': label.carried_from}
    return {'view': label.view, 'label': label.label, **{name: each for name, each in how.items() if each is not None}}


def _lesson_of(members: Members) -> Lesson:
    time, kind = members.get('time'), members.get('kind')
    return Lesson(
        episode=members['episode'],
        turn=members['turn'],
        stamp=None if time is None else time_of(time),
        seen=tuple(
            SeenView(view['view'], view['object'], exact(view['features'], f'the features of view {view["view"]}'))
            for view in members.get('seen', ())
        ),
        kind=None if kind is None else QueryKind(kind),
        teacher=members.get('teacher', ''),
        judgements=tuple(ViewJudgement(each['view'], each['matters']) for each in members.get('judgements', ())),
        labels=tuple(
            ViewLabel(label['view'], label['label'], label.get('left_out', False), label.get('carried_from'))
            for label in members.get('labels', ())
        ),
        withdrawn=tuple(members.get('withdrawn', ())),
        groups=tuple(members.get('groups', ())),
        unnameable=tuple(members.get('unnameable', ())),
        hearsay=tuple(Hearsay(said['view'], said['label'], said['teacher']) for said in members.get('hearsay', ())),
    )


def _origin_members(origin: Origin) -> Members:
    teachers = {name: dict(vars(counts)) for name, counts in origin.teachers.items()}
    told = {'strategy': origin.strategy, 'version': origin.version, 'world': origin.world, 'teachers': teachers}
    return {
        'episode_id': origin.episode,
        'symbols': list(origin.symbols),
        **{name: each for name, each in told.items() if each},
    }


def _origin_of(members: Members) -> Origin:
    return Origin(
        members['episode_id'],
        tuple(members['symbols']),
        members.get('strategy', ''),
        members.get('world'),
        members.get('version', ''),
        {
            name: TeacherCounts(**{each: counts[each] for each in TeacherCounts.__dataclass_fields__})
            for name, counts in members.get('teachers', {}).items()
        },
    )
