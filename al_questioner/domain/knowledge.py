"""All that a learner knows: what it has seen and what it was told, in their order, whichever episode they are of.

Beliefs follow from it: learnt again in this order, by a learner of the same symbols and classifiers, they are the same
to the last bit (docs/reference/concepts_file.md).
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile
from typing import Any

from al_questioner.domain.errors import InputError
from al_questioner.domain.names import quoted
from al_questioner.domain.query import NO_SYMBOL, QueryKind
from al_questioner.domain.scene import groups_of
from al_questioner.domain.settings import Classifiers


@dataclass(frozen=True)
class SeenView:
    """One object as it looked when this look of it was new.

    Attributes:
        number: by which labels refer to the view; each is another one.
        object_id: of its episode; another episode may give the same id to another object.
        features: m raw features; each is a float32.
    """

    number: int
    object_id: int
    features: tuple[float, ...]


@dataclass(frozen=True)
class ViewLabel:
    """Label of a view, by the view's number: a symbol or `NO_SYMBOL`.

    It was left out if it is of `NO_SYMBOL` only because it was not among the things that matter. It was carried from
    another view of the same object if that one got the label, and this one only with it.
    """

    view: int
    label: str
    left_out: bool = False
    carried_from: int | None = None

    @property
    def is_carried(self) -> bool:
        """True if nobody said it of this view."""
        return self.carried_from is not None


@dataclass(frozen=True)
class ViewJudgement:
    """Judgement of a view, by its number: whether it matters, that is, is of some symbol."""

    view: int
    matters: bool


@dataclass(frozen=True)
class Hearsay:
    """A label that a teacher gave to a view, by its number, and that is not learnt: it tells of the teacher only."""

    view: int
    label: str
    teacher: str


@dataclass(frozen=True)
class Lesson:
    """Content of one turn of an episode: the views that were new in it, and the answer to its question.

    Attributes:
        episode: its `episode_id`.
        turn: 1-based.
        stamp: time of the turn in nanoseconds, of the clock of its robot; None where it is not known.
        seen: the views that were new, in the order of their scene.
        kind: of the question; None if none was answered.
        teacher: who answered; empty if nobody did, or it is not known who.
        judgements: of a relevance query, in the order of the scene.
        labels: of the views that were named, here or by what was left out of a relevance query, or that had labels
            carried to them: those at sight, then what was said, then those that were seen before.
        withdrawn: numbers of views whose labels no longer count: they were left out before, and matter, or were
            carried, and something else was said.
        groups: the feature groups that the teacher called relevant; none if that was not asked.
        unnameable: numbers of views that the teacher was asked to name and could not.
        hearsay: what others said about the same, and what was outvoted in a merge.
    """

    episode: str
    turn: int
    stamp: int | None = None
    seen: tuple[SeenView, ...] = ()
    kind: QueryKind | None = None
    teacher: str = ''
    judgements: tuple[ViewJudgement, ...] = ()
    labels: tuple[ViewLabel, ...] = ()
    withdrawn: tuple[int, ...] = ()
    groups: tuple[str, ...] = ()
    unnameable: tuple[int, ...] = ()
    hearsay: tuple[Hearsay, ...] = ()

    @property
    def carried_at_sight(self) -> tuple[ViewLabel, ...]:
        """Labels that were carried to views when these were seen, before anything was said."""
        return tuple(takewhile(lambda label: label.is_carried, self.labels))

    @property
    def said(self) -> tuple[ViewLabel, ...]:
        """Labels that were not carried."""
        return tuple(label for label in self.labels if not label.is_carried)

    @property
    def is_empty(self) -> bool:
        """True if nothing would be lost with it."""
        said = self.judgements or self.labels or self.withdrawn or self.groups or self.unnameable or self.hearsay
        return not (self.seen or said)


@dataclass(frozen=True)
class TeacherCounts:
    """Counts of a teacher's answers in an episode, or in all.

    Attributes:
        answered: answers that count.
        unknown: questions of which the teacher did not know the answer.
        skipped: questions that the teacher skipped.
        corrected: answers of this teacher that were replaced.
        late: answers to questions that already had another answer.
    """

    answered: int = 0
    unknown: int = 0
    skipped: int = 0
    corrected: int = 0
    late: int = 0

    def plus(self, other: TeacherCounts) -> TeacherCounts:
        """Return the counts of both."""
        return TeacherCounts(**{name: count + getattr(other, name) for name, count in vars(self).items()})


@dataclass(frozen=True)
class Origin:
    """An episode that lessons come from.

    Attributes:
        symbols: that could be said in it: its `none` is none of these.
        strategy: who asked; empty where it is not known.
        world: the simulated world, as in an `episode` document; None if it was another one.
        version: of this package.
        teachers: counts of the answers in it by the teachers' names.
    """

    episode: str
    symbols: tuple[str, ...]
    strategy: str = ''
    world: Mapping[str, Any] | None = None
    version: str = ''
    teachers: Mapping[str, TeacherCounts] = field(default_factory=dict)


@dataclass(frozen=True)
class Statistics:
    """Statistics of the observed views, by which features are standardised, for those who only read.

    Attributes:
        count: number of views.
        mean: m numbers.
        scale: m standard deviations; 1 for a constant feature.
        features_in_use: names of the features that the classifiers use.
    """

    count: int
    mean: tuple[float, ...]
    scale: tuple[float, ...]
    features_in_use: tuple[str, ...]


@dataclass(frozen=True)
class Knowledge:
    """All that a learner knows.

    Attributes:
        symbols: the concepts, in the order of the classifiers.
        feature_names: m names.
        classifiers: settings of the classifiers.
        length_scale: of their kernel in standard deviations; None: root of the number of features in use.
        selection: name of the computational selection of features (`concepts.feature_selection`); empty for none.
        lessons: in the order in which they are learnt; those of an episode by their turns.
        origins: the episodes that the lessons come from.
        reliabilities: estimated probability that a label is right, by the teachers' names; a teacher of whom nobody
            has estimated it is not in it.
        statistics: that follow from the lessons; None if nobody has computed them.

    Raises:
        InputError: parts that do not fit each other.
    """

    symbols: tuple[str, ...]
    feature_names: tuple[str, ...]
    classifiers: Classifiers
    length_scale: float | None = None
    selection: str = ''
    lessons: tuple[Lesson, ...] = ()
    origins: tuple[Origin, ...] = ()
    reliabilities: Mapping[str, float] = field(default_factory=dict)
    statistics: Statistics | None = None

    def __post_init__(self) -> None:
        for names, what, least in ((self.symbols, 'symbols', 2), (self.feature_names, 'features', 1)):
            if len(names) < least or len(set(names)) < len(names) or not all(name.strip() for name in names):
                raise InputError(f'{what} must be distinct names, at least {least}, not {list(names)}')
        if NO_SYMBOL in self.symbols:
            raise InputError(f'{NO_SYMBOL!r} cannot be a symbol')
        self.classifiers.check(self.length_scale)
        self._check_views()
        self._check_what_was_said()

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups of the features, in the order in which they occur."""
        return groups_of(self.feature_names)

    @property
    def relevant_groups(self) -> tuple[str, ...]:
        """Groups that a teacher called relevant last; none if no teacher was asked."""
        return next((lesson.groups for lesson in reversed(self.lessons) if lesson.groups), ())

    @property
    def teachers(self) -> dict[str, TeacherCounts]:
        """Counts of all answers by the teachers' names, in their order."""
        found: dict[str, TeacherCounts] = {}
        for origin in self.origins:
            for name, counts in origin.teachers.items():
                found[name] = found.get(name, TeacherCounts()).plus(counts)
        return dict(sorted(found.items()))

    @cached_property
    def views(self) -> Mapping[int, SeenView]:
        """All views by their numbers, in the order in which they were seen."""
        return {view.number: view for lesson in self.lessons for view in lesson.seen}

    @property
    def examples(self) -> tuple[tuple[Lesson, ViewLabel], ...]:
        """All labels that count, each with the lesson that it is of; in the order of the lessons."""
        return tuple(
            (self.lessons[index], self.lessons[index].labels[place]) for index, place in self.places_of_examples
        )

    @cached_property
    def places_of_examples(self) -> tuple[tuple[int, int], ...]:
        """Index of the lesson, and place in it, of each label that counts; in the order of the lessons."""
        found: list[tuple[int, int]] = []
        for index, lesson in enumerate(self.lessons):
            at_sight, gone = len(lesson.carried_at_sight), set(lesson.withdrawn)
            found += [(index, place) for place in range(at_sight)]
            if gone:
                found = [(at, place) for at, place in found if not self._is_inferred(at, place, gone)]
            found += [(index, place) for place in range(at_sight, len(lesson.labels))]
        return tuple(found)

    @property
    def counts(self) -> dict[str, int]:
        """Number of examples of each symbol, and of `NO_SYMBOL` as the last."""
        labels = [label.label for _, label in self.examples]
        return {name: labels.count(name) for name in (*self.symbols, NO_SYMBOL)}

    def teacher_of(self, lesson: Lesson, label: ViewLabel) -> str:
        """Return who gave a label of a lesson, or the one that it was carried from; empty if that is not known."""
        if not label.is_carried:
            return lesson.teacher
        source = (label.carried_from, label.label)
        sources = [each for each in self.lessons if source in {(said.view, said.label) for said in each.said}]
        return sources[-1].teacher if sources else ''

    def _is_inferred(self, index: int, place: int, views: Collection[int]) -> bool:
        label = self.lessons[index].labels[place]
        return (label.left_out or label.is_carried) and label.view in views

    def _check_views(self) -> None:
        m, numbers = len(self.feature_names), [view.number for lesson in self.lessons for view in lesson.seen]
        if len(set(numbers)) < len(numbers):
            repeated = next(number for number in numbers if numbers.count(number) > 1)
            raise InputError(f'view {repeated} occurs twice')
        for view in self.views.values():
            if len(view.features) != m:
                raise InputError(f'view {view.number} has {len(view.features)} features, expected {m}')

    def _check_what_was_said(self) -> None:
        origins = {origin.episode for origin in self.origins}
        if len(origins) < len(self.origins):
            raise InputError('an episode occurs twice among the origins')
        known: set[int] = set()
        turns: set[tuple[str, int]] = set()
        for lesson in self.lessons:
            where = f'turn {lesson.turn} of episode {lesson.episode}'
            if lesson.episode not in origins:
                raise InputError(f'{where}: the episode is not among the origins')
            if (lesson.episode, lesson.turn) in turns:
                raise InputError(f'{where} occurs twice')
            turns.add((lesson.episode, lesson.turn))
            ids = [view.object_id for view in lesson.seen]
            if len(set(ids)) < len(ids):
                raise InputError(f'{where}: an object was seen twice')
            known.update(view.number for view in lesson.seen)
            named = [label.view for label in lesson.labels] + [each.view for each in lesson.judgements]
            named += [label.carried_from for label in lesson.labels if label.carried_from is not None]
            for number in (*named, *(said.view for said in lesson.hearsay), *lesson.unnameable, *lesson.withdrawn):
                if number not in known:
                    raise InputError(f'{where}: view {number} was not seen by then')
            for label in lesson.labels:
                if label.label not in self.symbols and label.label != NO_SYMBOL:
                    raise InputError(f'{where}: unknown label {quoted(label.label)}')
            for group in lesson.groups:
                if group not in self.groups:
                    raise InputError(f'{where}: unknown feature group {quoted(group)}')
