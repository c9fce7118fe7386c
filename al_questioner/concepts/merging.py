"""Knowledge of several learners as that of one: of two robots, two days, or two teachers."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeVar

from al_questioner.concepts.lessons import check_fits
from al_questioner.domain import Hearsay, InputError, Knowledge, Lesson, Origin, SeenView, ViewLabel
from al_questioner.domain.settlement import REFUSE, RELIABLE

_Each = TypeVar('_Each')


class _Told(NamedTuple):
    """A label that is learnt, and where it stands: which lesson, which of its labels."""

    lesson: int
    place: int
    label: ViewLabel
    teacher: str


@dataclass(frozen=True)
class Contradiction:
    """One view that has several labels.

    Attributes:
        views: its numbers; several if it was seen several times.
        labels: what was said, and by whom, in the order of the lessons.
        kept: the label that counts; None if it was not settled.
    """

    views: tuple[int, ...]
    labels: tuple[tuple[str, str], ...]
    kept: str | None

    def __str__(self) -> str:
        said = ', '.join(f'{label} ({teacher or "nobody knows who"})' for label, teacher in self.labels)
        came = '' if self.kept is None else f'; {self.kept} is kept'
        return f'view {", ".join(map(str, self.views))} was called {said}{came}'


def joined_knowledge(parts: Sequence[tuple[str, Knowledge]]) -> Knowledge:
    """Return the lessons of all, those that are in several once; contradictions stay in it.

    The lessons are learnt in the order in which they are given. Symbols are those of all; the settings of the
    classifiers are the first one's. Statistics and reliabilities are left out.

    Args:
        parts: knowledge, each with a name for messages, such as its file.

    Raises:
        InputError: other features, or the same turn of the same episode in two versions that cannot both be true.
    """
    (_, first), *others = parts
    for name, other in others:
        try:
            check_fits(other, first.feature_names)
        except InputError as error:
            raise InputError(f'{name}: {error}') from error
    joining = _Joining()
    for name, part in parts:
        joining.add(name, part)
    symbols = dict.fromkeys(symbol for _, part in parts for symbol in part.symbols)
    return replace(
        first,
        symbols=tuple(symbols),
        lessons=tuple(lesson for lesson in joining.lessons.values() if not lesson.is_empty),
        origins=tuple(joining.origins.values()),
        statistics=None,
        reliabilities={},
    )


class _Joining:
    """Lessons by episode and turn, with new numbers for the views."""

    def __init__(self) -> None:
        self.lessons: dict[tuple[str, int], Lesson] = {}
        self.origins: dict[str, Origin] = {}
        self._numbers: dict[tuple[str, int, int], SeenView] = {}

    def add(self, name: str, part: Knowledge) -> None:
        """Add all lessons of a part that are not there yet; of two versions of an episode, the later one counts."""
        later: dict[str, int] = {}
        for origin in part.origins:
            known = self.origins.setdefault(origin.episode, origin)
            later[origin.episode] = _answers(origin) - _answers(known)
            if later[origin.episode] > 0:
                self.origins[origin.episode] = origin
        self._forget_what_was_said(part, {episode for episode, more in later.items() if more > 0})
        renumbered: dict[int, int] = {}
        for lesson in part.lessons:
            where, is_later = (lesson.episode, lesson.turn), later[lesson.episode]
            seen = {each.object_id: self._renumber(name, where, each, renumbered, is_later) for each in lesson.seen}
            other = _renumbered(replace(lesson, seen=()), renumbered)
            before = self.lessons.get(where)
            if before is not None:
                seen = {each.object_id: self._numbers[(*where, each.object_id)] for each in before.seen} | seen
                other = other if is_later > 0 else before if is_later < 0 else _united(name, before, other)
            elif is_later < 0:
                other = _without_words(other)
            self.lessons[where] = replace(other, seen=tuple(seen.values()))

    def _forget_what_was_said(self, part: Knowledge, episodes: Collection[str]) -> None:
        """Forget what was said in turns of these episodes of which the part, a later version, tells nothing.

        It was taken back since, as by a correction that says nothing.
        """
        told = {(lesson.episode, lesson.turn) for lesson in part.lessons}
        for where, lesson in self.lessons.items():
            if lesson.episode in episodes and where not in told:
                self.lessons[where] = _without_words(lesson)

    def _renumber(
        self, name: str, where: tuple[str, int], view: SeenView, renumbered: dict[int, int], is_later: int
    ) -> SeenView:
        """Return a view under its new number, with the features of the later version."""
        key = (*where, view.object_id)
        known = self._numbers.get(key)
        if known is not None and known.features != view.features and is_later == 0:
            episode, turn = where
            raise InputError(
                f'{name}: object {view.object_id} in turn {turn} of episode {episode} looks otherwise than in a file'
                ' before: keep one of the two files'
            )
        number = len(self._numbers) + 1 if known is None else known.number
        if known is None or is_later > 0:
            self._numbers[key] = SeenView(number, view.object_id, view.features)
        renumbered[view.number] = number
        return self._numbers[key]


def settled(
    knowledge: Knowledge, settlement: str, reliabilities: Mapping[str, float]
) -> tuple[Knowledge, list[Contradiction]]:
    """Return the knowledge with each view learnt as one thing, and the contradictions that it had.

    Views are the same if they are to the last bit. What does not count, because the same is learnt from another episode
    or because another label is kept, stays as hearsay, for what it tells of its teacher. A label that was carried gives
    way to one that was said; those that were carried from a view whose label does not count go with it.

    Args:
        knowledge: as `joined_knowledge` returns it.
        settlement: one of `SETTLEMENTS`. `newest`: the last one counts, by time, or by the order of the lessons where a
            time is not known. `reliable`: that of the most reliable teacher, the last one's of equal ones. `refuse`:
            nothing is settled, the labels stay.
        reliabilities: by the teachers' names.
    """
    by_look: dict[tuple[float, ...], list[_Told]] = defaultdict(list)
    for index, place in knowledge.places_of_examples:
        lesson = knowledge.lessons[index]
        label = lesson.labels[place]
        by_look[knowledge.views[label.view].features].append(
            _Told(index, place, label, knowledge.teacher_of(lesson, label))
        )
    found: list[Contradiction] = []
    outvoted: dict[int, set[int]] = defaultdict(set)
    refuted: set[int] = set()
    heard: dict[int, list[Hearsay]] = defaultdict(list)
    for told in by_look.values():
        labels = {each.label.label for each in told}
        winner = _winner(knowledge, told, settlement, reliabilities) if len(labels) > 1 else told[0]
        if len(labels) > 1:
            kept = None if winner is None else winner.label.label
            views = tuple(dict.fromkeys(each.label.view for each in told))
            found.append(Contradiction(views, tuple((each.label.label, each.teacher) for each in told), kept))
        if winner is None:
            continue
        episode = knowledge.lessons[winner.lesson].episode
        for each in told:
            # An episode may ask twice, and counts both answers; that is how its learner believes.
            is_repeated = each.label.label == winner.label.label and knowledge.lessons[each.lesson].episode == episode
            if each is not winner and not is_repeated:
                outvoted[each.lesson].add(each.place)
                if each.label.label != winner.label.label:
                    refuted.add(each.label.view)
                if each.teacher and not each.label.is_carried:
                    heard[winner.lesson].append(Hearsay(winner.label.view, each.label.label, each.teacher))
    lessons = tuple(
        replace(
            lesson,
            labels=tuple(
                label
                for place, label in enumerate(lesson.labels)
                if place not in outvoted[index] and label.carried_from not in refuted
            ),
            hearsay=(*lesson.hearsay, *heard[index]),
        )
        for index, lesson in enumerate(knowledge.lessons)
    )
    kept_lessons = tuple(lesson for lesson in lessons if not lesson.is_empty)
    return replace(knowledge, lessons=kept_lessons, statistics=None, reliabilities={}), found


def _winner(
    knowledge: Knowledge, told: Sequence[_Told], settlement: str, reliabilities: Mapping[str, float]
) -> _Told | None:
    """Return the label that counts of those of one view; None to settle nothing."""
    if settlement == REFUSE:
        return None
    stamps = [knowledge.lessons[each.lesson].stamp for each in told]
    times = [0 if stamp is None else stamp for stamp in stamps] if None not in stamps else [0] * len(told)

    def rank(which: int) -> tuple[bool, float, int, int]:
        reliable = reliabilities.get(told[which].teacher, 0.0) if settlement == RELIABLE else 0.0
        return not told[which].label.is_carried, reliable, times[which], which

    return told[max(range(len(told)), key=rank)]


def _answers(origin: Origin) -> int:
    """Return how many answers an origin tells of; of two versions of an episode, the later one has more."""
    return sum(sum(vars(counts).values()) for counts in origin.teachers.values())


def _renumbered(lesson: Lesson, numbers: Mapping[int, int]) -> Lesson:
    return replace(
        lesson,
        labels=tuple(
            replace(
                each,
                view=numbers[each.view],
                carried_from=None if each.carried_from is None else numbers[each.carried_from],
            )
            for each in lesson.labels
        ),
        judgements=tuple(replace(each, view=numbers[each.view]) for each in lesson.judgements),
        hearsay=tuple(replace(each, view=numbers[each.view]) for each in lesson.hearsay),
        withdrawn=tuple(numbers[number] for number in lesson.withdrawn),
        unnameable=tuple(numbers[number] for number in lesson.unnameable),
    )


def _without_words(lesson: Lesson) -> Lesson:
    """Return a lesson of what was seen only."""
    return Lesson(lesson.episode, lesson.turn, lesson.stamp, lesson.seen)


def _united(name: str, known: Lesson, other: Lesson) -> Lesson:
    """Return one lesson of two of the same turn, neither of which is the later one: a person has changed one.

    Raises:
        InputError: they are answers to different questions.
    """
    if known.kind is not None and other.kind is not None and known.kind is not other.kind:
        raise InputError(
            f'{name}: turn {other.turn} of episode {other.episode} asked something else than in a file before: keep one'
            ' of the two files'
        )
    later = other if other.kind is not None else known
    return replace(
        later,
        stamp=later.stamp if later.stamp is not None else known.stamp,
        judgements=_all_of(known.judgements, other.judgements),
        labels=_all_of(known.labels, other.labels),
        withdrawn=_all_of(known.withdrawn, other.withdrawn),
        unnameable=_all_of(known.unnameable, other.unnameable),
        hearsay=_all_of(known.hearsay, other.hearsay),
    )


def _all_of(first: tuple[_Each, ...], second: tuple[_Each, ...]) -> tuple[_Each, ...]:
    return tuple(dict.fromkeys((*first, *second)))
