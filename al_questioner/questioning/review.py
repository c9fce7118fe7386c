"""Review of what is known: what follows from it, how far teachers can be relied on, and which labels are doubtful."""

from __future__ import annotations

from dataclasses import dataclass, replace

from al_questioner.concepts import ConceptLearner
from al_questioner.concepts.feature_selection import selector_named
from al_questioner.concepts.lessons import learn_again, statistics_of
from al_questioner.domain import NO_SYMBOL, EpisodeSettings, Knowledge, Lesson, ViewLabel
from al_questioner.questioning.initial_concepts import taught_concept_learner
from al_questioner.questioning.reliability import label_beliefs, reliabilities, statements_in
from al_questioner.support.arrays import Array

DOUBT = 0.1
"""Largest probability, by all other labels, of a label that is doubtful."""


@dataclass(frozen=True)
class DoubtfulLabel:
    """A label that the other labels contradict.

    Attributes:
        lesson: in which it was given.
        label: what was said.
        belief: its probability by all other labels.
        likely: the most probable label by all others, a symbol or `NO_SYMBOL`.
        likelihood: the probability of that.
    """

    lesson: Lesson
    label: ViewLabel
    belief: float
    likely: str
    likelihood: float


def settings_for(knowledge: Knowledge) -> EpisodeSettings:
    """Return settings with which a learner believes what follows from the knowledge alone."""
    return EpisodeSettings(
        symbols=knowledge.symbols,
        budget=0.0,
        turns=1,
        strategy='',
        amplitude=knowledge.classifiers.amplitude,
        length_scale=knowledge.length_scale,
        kernel_shape=knowledge.classifiers.kernel_shape,
        class_balance=knowledge.classifiers.class_balance,
        concepts=knowledge,
    )


def taught_learner(knowledge: Knowledge) -> ConceptLearner:
    """Return a learner that was taught all lessons: it believes, to the last bit, what the learner of them believed.

    That is so if the features were not selected, or by a selector of this package.
    """
    return _taught(knowledge)[0]


class KnowledgeFollower:
    """Learner that follows what another one knows, as it grows: only lessons that are new are taught.

    It believes, to the last bit, what `taught_learner` of the same knowledge believes.
    """

    def __init__(self) -> None:
        self._learner: ConceptLearner | None = None
        self._known: Knowledge | None = None

    def follow(self, knowledge: Knowledge) -> ConceptLearner:
        """Return the learner once it knows this; it is the same object as before if it had only to learn more.

        Raises:
            InputError: lessons that do not fit each other.
        """
        learner, known = self._learner, self._known
        # Should a lesson fail, the next knowledge is learnt from its beginning.
        self._learner = self._known = None
        if learner is None or known is None or not _continues(known, knowledge):
            learner = taught_learner(knowledge)
        else:
            learn_again(learner, knowledge, first=len(known.lessons))
        self._learner, self._known = learner, knowledge
        return learner


def reviewed(knowledge: Knowledge) -> Knowledge:
    """Return the knowledge with the statistics and the reliabilities that follow from it."""
    concepts, beliefs = _taught(knowledge)
    estimated = reliabilities(statements_in(knowledge, knowledge.symbols), beliefs, knowledge.teachers)
    return replace(
        knowledge,
        statistics=statistics_of(concepts) if knowledge.views else None,
        reliabilities=dict(sorted(estimated.items())),
    )


def doubtful_labels(knowledge: Knowledge) -> list[DoubtfulLabel]:
    """Return the labels that all other labels make improbable, the least probable first."""
    by_others = taught_learner(knowledge).predict_each_from_others()
    names = (*knowledge.symbols, NO_SYMBOL)
    found = []
    for (lesson, label), degrees in zip(knowledge.examples, by_others, strict=True):
        beliefs = label_beliefs(degrees)
        belief, best = float(beliefs[names.index(label.label)]), int(beliefs.argmax())
        if belief <= DOUBT:
            found.append(DoubtfulLabel(lesson, label, belief, names[best], float(beliefs[best])))
    return sorted(found, key=lambda doubt: doubt.belief)


def _taught(knowledge: Knowledge) -> tuple[ConceptLearner, dict[int, Array]]:
    return taught_concept_learner(settings_for(knowledge), selector_named(knowledge.selection))


def _continues(known: Knowledge, knowledge: Knowledge) -> bool:
    """Return whether a learner of what is known needs only the lessons behind it to know all."""
    are_same = all(
        getattr(known, name) == getattr(knowledge, name)
        for name in ('symbols', 'feature_names', 'classifiers', 'length_scale', 'selection')
    )
    return are_same and knowledge.lessons[: len(known.lessons)] == known.lessons
