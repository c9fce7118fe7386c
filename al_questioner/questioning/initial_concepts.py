"""The concept learner at the beginning of an episode."""

from __future__ import annotations

from al_questioner.concepts import VIEW_TOLERANCE, ConceptLearner, Selector
from al_questioner.concepts.kernel import KERNEL_SHAPES
from al_questioner.concepts.lessons import LessonWatcher, features_of, learn_again
from al_questioner.domain import EpisodeSettings, Lesson
from al_questioner.questioning.reliability import item_of, label_beliefs, view_in_question
from al_questioner.support.arrays import Array


def new_concept_learner(
    settings: EpisodeSettings, selector: Selector | None, view_tolerance: float = VIEW_TOLERANCE
) -> ConceptLearner:
    """Make the concept learner of these settings and the strategy's selector, as it is before the first turn."""
    return taught_concept_learner(settings, selector, view_tolerance)[0]


def taught_concept_learner(
    settings: EpisodeSettings, selector: Selector | None, view_tolerance: float = VIEW_TOLERANCE
) -> tuple[ConceptLearner, dict[int, Array]]:
    """Make that learner, and tell what it believed of what it knows already before it was named.

    Returns:
        The learner, and by `item_of` each lesson in which one view was named, (L,) the belief in each label.
    """
    concepts = ConceptLearner(
        settings.symbols,
        settings.amplitude,
        settings.length_scale,
        selector,
        view_tolerance,
        KERNEL_SHAPES[settings.kernel_shape],
        settings.class_balance,
    )
    beliefs: dict[int, Array] = {}
    knowledge = settings.concepts
    if knowledge is not None:
        views = knowledge.views

        def note(index: int, lesson: Lesson) -> None:
            view = view_in_question(lesson)
            if view is not None:
                beliefs[item_of(index)] = label_beliefs(concepts.predict_proba(features_of(views[view])[None])[0])

        watch: LessonWatcher = note
        learn_again(concepts, knowledge, watch)
    if settings.carry_labels:
        # Only now: the lessons tell themselves what was carried, and ids meant other things then.
        concepts.carry_labels()
    return concepts, beliefs
