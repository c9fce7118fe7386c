"""Learning again what is known: a learner is given lessons of earlier episodes, in their order."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.concept_learner import ConceptLearner
from al_questioner.concepts.standardiser import Standardiser
from al_questioner.concepts.taught_views import JudgedView, LabelledView
from al_questioner.domain import InputError, Knowledge, Lesson, Scene, SeenView, Statistics, ViewLabel

BEFORE = 0
"""Turn of what is known from earlier episodes: before the first."""

LessonWatcher = Callable[[int, Lesson], None]
"""Function that is called with the index of each lesson and the lesson, after its views and before what was said."""


def learn_again(
    concepts: ConceptLearner, knowledge: Knowledge, watch: LessonWatcher | None = None, first: int = 0
) -> None:
    """Teach a learner all lessons, in their order, as they were taught.

    A fit depends in the last digits on the fits before, so the result is that of the learner which was taught first
    only if each event is repeated. It is, to the last bit, if the learners have the same symbols and classifiers.

    Args:
        concepts: knows nothing but the lessons before the first one; it may have more symbols than the knowledge.
        knowledge: what it is to know.
        watch: looks on.
        first: index of the first lesson to teach.

    Raises:
        InputError: a label is none of the learner's symbols.
    """
    views = knowledge.views
    for index, lesson in enumerate(knowledge.lessons[first:], start=first):
        at_sight = len(lesson.carried_at_sight) if lesson.seen else 0
        labels = [_labelled_view(views[each.view], each) for each in lesson.labels]
        if lesson.seen:
            concepts.observe(scene_of(lesson.seen, knowledge.feature_names), BEFORE, labels[:at_sight])
        if watch is not None:
            watch(index, lesson)
        if lesson.groups:
            concepts.restrict_to_groups(lesson.groups)
        for number in lesson.unnameable:
            concepts.note_unnameable(views[number].object_id, features_of(views[number]))
        concepts.learn_views(
            [
                JudgedView(views[each.view].object_id, features_of(views[each.view]), each.matters, BEFORE)
                for each in lesson.judgements
            ],
            labels[at_sight:],
            lesson.withdrawn,
        )


def _labelled_view(view: SeenView, label: ViewLabel) -> LabelledView:
    return LabelledView(
        view.object_id, features_of(view), label.label, BEFORE, label.left_out, view.number, label.is_carried
    )


def scene_of(views: Iterable[SeenView], feature_names: tuple[str, ...]) -> Scene:
    """Return views as a scene; where the objects were is not known any more."""
    kept = tuple(views)
    features = np.array([view.features for view in kept], dtype=np.float32).reshape(len(kept), len(feature_names))
    positions = np.zeros((len(kept), 3), dtype=np.float32)
    return Scene(tuple(view.object_id for view in kept), positions, features, feature_names)


def features_of(view: SeenView) -> NDArray[np.float32]:
    """Return the (m,) features of a view."""
    return np.array(view.features, dtype=np.float32)


def check_fits(knowledge: Knowledge, feature_names: tuple[str, ...]) -> None:
    """Make sure that knowledge is of these features.

    Raises:
        InputError: it is of others.
    """
    ours = knowledge.feature_names
    if ours == feature_names:
        return
    lacking, other = (
        [name for name in these if name not in those] for these, those in ((feature_names, ours), (ours, feature_names))
    )
    what = [
        f'{verb} {names[0]}{", ..." if len(names) > 1 else ""}'
        for verb, names in (('lack', lacking), ('have', other))
        if names
    ]
    raise InputError(
        f'the concepts are of other features: they {" and ".join(what) or "have the same in another order"}'
    )


def statistics_of(concepts: ConceptLearner) -> Statistics:
    """Return the statistics of what a learner has seen."""
    standardiser: Standardiser = concepts.standardiser
    return Statistics(
        count=standardiser.count,
        mean=tuple(standardiser.mean.tolist()),
        scale=tuple(standardiser.scale.tolist()),
        features_in_use=concepts.features_in_use,
    )
