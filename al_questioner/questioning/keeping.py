"""Knowledge that an episode leaves, to keep it: the lessons of its turns behind those that it began with."""

from __future__ import annotations

import dataclasses
from collections import defaultdict
from collections.abc import Mapping

import numpy as np

from al_questioner.concepts.feature_selection import name_of_selector
from al_questioner.concepts.last_looks import LastLooks
from al_questioner.concepts.lessons import features_of, statistics_of
from al_questioner.concepts.taught_views import LabelledView
from al_questioner.domain import (
    Classifiers,
    EpisodeSettings,
    Hearsay,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    Outcome,
    QueryKind,
    QueryRecord,
    Scene,
    SeenView,
    ViewJudgement,
    ViewLabel,
)
from al_questioner.questioning.answers import AnswerHistory
from al_questioner.questioning.concept_history import ConceptHistory
from al_questioner.questioning.query_status import QueryBook
from al_questioner.questioning.reliability import TeacherRecord, answer_counts


def knowledge_after(
    settings: EpisodeSettings,
    history: ConceptHistory,
    queries: QueryBook,
    answers: AnswerHistory,
    teachers: Mapping[str, TeacherRecord],
    origin: Origin,
    stamps: Mapping[int, int],
) -> Knowledge:
    """Return all that is known after the turns of an episode so far, what it began with included.

    Args:
        settings: of the episode.
        history: its scenes and concepts.
        queries: what was asked.
        answers: what was said.
        teachers: records of the teachers, those of earlier episodes included.
        origin: what is told of the episode.
        stamps: time of each turn in nanoseconds, as far as it is known.

    Raises:
        InputError: nothing was seen yet, or an earlier episode had the same id.
    """
    before, concepts = settings.concepts, history.concepts
    if not concepts.feature_names:
        raise InputError('nothing is known yet: no scene was seen')
    origins = () if before is None else before.origins
    if origin.episode in {other.episode for other in origins}:
        raise InputError(f'what is known comes from an episode {origin.episode!r} already: give this one another id')
    # A kernel that was tuned, by a learner of an earlier version, is no more that of the settings.
    kernel, is_tuned = concepts.kernel, bool(history.tuned_turns)
    amplitude = kernel.amplitude if is_tuned else settings.amplitude
    return Knowledge(
        symbols=settings.symbols,
        feature_names=concepts.feature_names,
        classifiers=Classifiers(amplitude, settings.kernel_shape, settings.class_balance),
        length_scale=kernel.length_scale if is_tuned else settings.length_scale,
        selection=name_of_selector(history.selector),
        lessons=(
            *(() if before is None else before.lessons),
            *_Writing(before, origin, stamps).lessons(history, queries, answers),
        ),
        origins=(*origins, dataclasses.replace(origin, teachers=answer_counts(answers))),
        reliabilities={name: record.reliability for name, record in teachers.items()},
        statistics=statistics_of(concepts),
    )


class _Writing:
    """Writes the lessons of an episode; keeps which view each object shows."""

    def __init__(self, before: Knowledge | None, origin: Origin, stamps: Mapping[int, int]) -> None:
        self._origin, self._stamps = origin, stamps
        views = {} if before is None else before.views
        self._next = max(views, default=0) + 1
        self._shown = {view.object_id: view for view in views.values()}
        self._looks = LastLooks()
        for view in self._shown.values():
            self._looks.take((view.object_id,), features_of(view)[None])
        self._latest = {_key(view): view.number for view in views.values()}
        self._numbers: dict[LabelledView, int] = {}

    def lessons(self, history: ConceptHistory, queries: QueryBook, answers: AnswerHistory) -> list[Lesson]:
        """Return the lessons of the turns so far."""
        records = {record.turn: record for record in queries.records}
        labels, withdrawn = defaultdict(list), defaultdict(list)
        for labelled in history.concepts.learnt_labels:
            labels[labelled.turn].append(labelled)
        for gone in history.concepts.withdrawn_views:
            withdrawn[gone.turn].append(gone.view)
        teachers = {queries.by_id[answer.query_id].turn: answer.teacher_id for answer in answers.standing()}
        late = defaultdict(list)
        for answer in answers.late:
            late[queries.by_id[answer.query_id].turn].append(answer)
        found: list[Lesson] = []
        last: Scene | None = None
        for turn, scene in enumerate(history.scenes, start=1):
            seen = () if scene is last else self._new_views(scene)
            last, record = scene, records.get(turn)
            named = tuple(self._view_label(each) for each in labels[turn])
            lesson = Lesson(self._origin.episode, turn, self._stamps.get(turn), seen, labels=named)
            if record is not None and record.outcome is not Outcome.UNANSWERED:
                said = tuple(
                    Hearsay(self._shown[record.object_id].number, str(answer.content), answer.teacher_id)
                    for answer in late[turn]
                    if record.kind is QueryKind.LABEL
                    and record.object_id is not None
                    and answer.outcome is Outcome.ANSWERED
                )
                lesson = dataclasses.replace(
                    lesson,
                    kind=record.kind,
                    teacher=teachers.get(turn, ''),
                    judgements=self._judgements(record, scene),
                    withdrawn=tuple(self._number(each) for each in withdrawn[turn]),
                    groups=record.groups,
                    unnameable=self._unnameable(record),
                    hearsay=said,
                )
            if not lesson.is_empty:
                found.append(lesson)
        return found

    def _view_label(self, view: LabelledView) -> ViewLabel:
        source = None if view.source is None else self._number(view.source)
        return ViewLabel(self._number(view), view.label, view.was_left_out, source)

    def _number(self, view: LabelledView) -> int:
        """Return the number of a view, the latest one when it got its label, in this turn or an earlier one."""
        if view.number is not None:
            return view.number
        return self._numbers.setdefault(view, self._latest[view.object_id, view.features.tobytes()])

    def _new_views(self, scene: Scene) -> tuple[SeenView, ...]:
        """Return the views of a scene that its objects did not show when they were seen last."""
        found: list[SeenView] = []
        for row in self._looks.take(scene.object_ids, scene.features):
            features = scene.features[row].astype(np.float32)
            view = SeenView(self._next, scene.object_ids[row], tuple(features.tolist()))
            self._shown[view.object_id] = view
            self._latest[_key(view)] = self._next
            self._next += 1
            found.append(view)
        return tuple(found)

    def _judgements(self, record: QueryRecord, scene: Scene) -> tuple[ViewJudgement, ...]:
        if record.objects is None:
            return ()
        return tuple(ViewJudgement(self._shown[each].number, each in record.objects) for each in scene.object_ids)

    def _unnameable(self, record: QueryRecord) -> tuple[int, ...]:
        is_one = record.kind is QueryKind.LABEL and record.outcome is Outcome.UNKNOWN and record.object_id is not None
        return (self._shown[record.object_id].number,) if is_one and record.object_id is not None else ()


def _key(view: SeenView) -> tuple[int, bytes]:
    """Return the object of a view and the bits of its features."""
    return view.object_id, features_of(view).tobytes()
