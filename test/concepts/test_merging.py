"""Knowledge of several learners becomes that of one; what contradicts itself is named."""

from dataclasses import replace

import pytest

from al_questioner.concepts.editing import (
    with_symbol,
    with_symbol_renamed,
    without_example,
    without_symbol,
)
from al_questioner.concepts.merging import joined_knowledge, settled
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
from al_questioner.domain.settlement import NEWEST, REFUSE, RELIABLE

SYMBOLS = ('snack', 'fruit')


def taught(episode, labels, teacher='anna', stamp=1, symbols=SYMBOLS, features=('colour_red', 'size_height')):
    """Return knowledge of an episode in which one thing a turn was seen, at a place of its own, and named."""
    lessons = tuple(
        Lesson(
            episode,
            turn,
            stamp * 100 + turn,
            (SeenView(turn, turn, (float(look),) * len(features)),),
            QueryKind.LABEL,
            teacher,
            labels=(ViewLabel(turn, label),),
        )
        for turn, (look, label) in enumerate(labels, start=1)
    )
    origin = Origin(episode, symbols, teachers={teacher: TeacherCounts(len(lessons))})
    return Knowledge(symbols, features, Classifiers(), lessons=lessons, origins=(origin,))


def labels_of(knowledge):
    return [(knowledge.views[label.view].features[0], label.label) for _, label in knowledge.examples]


def merged(*parts, settlement=REFUSE, reliabilities=None):
    named = [(f'file {number}', part) for number, part in enumerate(parts, start=1)]
    return settled(joined_knowledge(named), settlement, reliabilities or {})


def test_two_days_are_put_together():
    """A robot could learn from one of two robots only."""
    found, contradictions = merged(
        taught('a', [(1, 'snack'), (2, 'none')]), taught('b', [(3, 'tool')], symbols=('tool', 'cup'))
    )
    assert not contradictions
    assert labels_of(found) == [(1.0, 'snack'), (2.0, 'none'), (3.0, 'tool')]
    assert found.symbols == (*SYMBOLS, 'tool', 'cup')
    assert found.teachers == {'anna': TeacherCounts(3)}


def test_the_same_lesson_counts_once():
    """A file that is merged with its successor would count twice."""
    first = taught('a', [(1, 'snack')])
    whole = taught('a', [(1, 'snack'), (2, 'fruit')])
    assert merged(first, whole)[0].lessons == merged(whole, first)[0].lessons == whole.lessons
    assert merged(first, whole)[0].teachers == {'anna': TeacherCounts(2)}
    assert merged(whole, whole)[0] == whole


def test_a_later_version_of_an_episode_counts():
    """A correction is undone by an older file, or counts beside what it corrects."""
    wrong, right = taught('a', [(1, 'snack')]), taught('a', [(1, 'fruit')])
    right = replace(right, origins=(replace(right.origins[0], teachers={'anna': TeacherCounts(1, corrected=1)}),))
    for parts in ((wrong, right), (right, wrong)):
        found, contradictions = merged(*parts)
        assert (labels_of(found), contradictions) == ([(1.0, 'fruit')], [])


def test_what_was_taken_back_stays_so():
    """A label that a correction took back would count again: the later version need not tell of its turn at all."""
    first = taught('a', [(1, 'snack'), (2, 'snack')])
    again = Lesson('a', 3, 303, kind=QueryKind.LABEL, teacher='anna', labels=(ViewLabel(2, 'fruit'),))
    first = replace(first, lessons=(*first.lessons, again))
    corrected = replace(
        first,
        lessons=first.lessons[:2],
        origins=(replace(first.origins[0], teachers={'anna': TeacherCounts(3, 0, 1, 1)}),),
    )
    for parts in ((first, corrected), (corrected, first)):
        found, contradictions = merged(*parts)
        assert not contradictions
        assert found.lessons == corrected.lessons


def test_what_was_seen_is_kept_with_a_later_version():
    """Otherwise nobody could tell what another episode says of the view."""
    first, other = taught('a', [(1, 'snack'), (2, 'fruit')]), taught('a', [(1, 'snack')])
    later = replace(other, origins=(replace(other.origins[0], teachers={'anna': TeacherCounts(3)}),))
    for parts in ((first, later), (later, first)):
        found, _ = merged(*parts)
        assert [view.features[0] for view in found.views.values()] == [1, 2]
        assert labels_of(found) == [(1, 'snack')]


def test_the_same_example_of_two_episodes_counts_once():
    """The same picture, shown to two robots, weighs double."""
    found, contradictions = merged(taught('a', [(1, 'snack')]), taught('b', [(1, 'snack')], 'bob'))
    assert (labels_of(found), contradictions) == ([(1.0, 'snack')], [])
    assert found.lessons[0].hearsay == (Hearsay(1, 'snack', 'bob'),)


@pytest.mark.parametrize(
    ('settlement', 'stamps', 'kept'),
    [(REFUSE, (1, 2), None), (NEWEST, (1, 2), 'fruit'), (NEWEST, (2, 1), 'snack'), (RELIABLE, (1, 2), 'snack')],
)
def test_contradictions_are_named_and_settled(settlement, stamps, kept):
    """Two teachers who disagree leave a robot that does not know either."""
    parts = taught('a', [(1, 'snack')], 'anna', stamps[0]), taught('b', [(1, 'fruit'), (2, 'none')], 'bob', stamps[1])
    found, (contradiction,) = merged(*parts, settlement=settlement, reliabilities={'anna': 0.9, 'bob': 0.6})
    assert contradiction.kept == kept
    assert str(contradiction).startswith('view 1, 2 was called snack (anna), fruit (bob)')
    expected = [(1.0, 'snack'), (1.0, 'fruit')] if kept is None else [(1.0, kept)]
    assert labels_of(found) == [*expected, (2.0, 'none')]
    if kept is not None:
        heard = [(said.label, said.teacher) for lesson in found.lessons for said in lesson.hearsay]
        assert heard == [{'snack': ('fruit', 'bob'), 'fruit': ('snack', 'anna')}[kept]]


def test_other_features_are_refused():
    """Numbers of one sensor are taken for those of another."""
    with pytest.raises(
        InputError, match='file 2: the concepts are of other features: they lack size_height and have size_width'
    ):
        merged(taught('a', [(1, 'snack')]), taught('b', [(1, 'snack')], features=('colour_red', 'size_width')))


def test_an_episode_that_was_two_things_is_refused():
    """Files of which one is not true are mixed."""
    with pytest.raises(InputError, match='file 2: object 1 in turn 1 of episode a looks otherwise'):
        merged(taught('a', [(1, 'snack')]), taught('a', [(2, 'snack')]))


def test_an_example_is_removed():
    """A label that a person found to be wrong stays."""
    found = without_example(taught('a', [(1, 'snack'), (2, 'fruit')]), 1)
    assert labels_of(found) == [(2.0, 'fruit')]
    assert len(found.views) == 2
    with pytest.raises(InputError, match='view 1 is no example'):
        without_example(found, 1)


def test_what_followed_from_it_goes_with_a_change():
    """A file would show a teacher's reliability that does not follow from what it holds."""
    before = replace(taught('a', [(1, 'snack'), (2, 'fruit')], symbols=(*SYMBOLS, 'tool')), reliabilities={'anna': 0.3})
    before = replace(before, statistics=Statistics(2, (1.5, 1.5), (1.0, 1.0), before.feature_names))
    changed = (
        without_example(before, 1),
        without_symbol(before, 'tool'),
        with_symbol(before, 'cup'),
        with_symbol_renamed(before, 'tool', 'cup'),
    )
    assert all((each.statistics, each.reliabilities) == (None, {}) for each in changed)


def test_an_answer_that_was_given_twice_in_an_episode_counts_twice():
    """The learner of the merged file would believe less than that of the episode did."""
    whole = taught('a', [(1, 'snack'), (1, 'snack')])
    assert labels_of(merged(whole, taught('b', [(3, 'fruit')]))[0]) == [(1, 'snack'), (1, 'snack'), (3, 'fruit')]


def test_a_carried_label_is_of_who_said_it_last():
    """The teacher who was only the first to say it would answer for it."""
    lessons = (*taught('a', [(1, 'snack')]).lessons, Lesson('a', 2, 202, (), QueryKind.LABEL, 'bob'))
    again = replace(lessons[1], labels=(ViewLabel(1, 'snack'),))
    carried = Lesson('a', 3, 303, (SeenView(2, 1, (5.0, 5.0)),), labels=(ViewLabel(2, 'snack', carried_from=1),))
    found = replace(taught('a', [(1, 'snack')]), lessons=(lessons[0], again, carried))
    assert found.teacher_of(carried, carried.labels[0]) == 'bob'


def test_a_symbol_is_renamed_wherever_it_is_said():
    """Half of the examples keep the old name."""
    before = taught('a', [(1, 'snack'), (2, 'fruit')])
    before = replace(
        before, lessons=(before.lessons[0], replace(before.lessons[1], hearsay=(Hearsay(2, 'snack', 'eve'),)))
    )
    found = with_symbol_renamed(before, 'snack', 'nibble')
    assert found.symbols == found.origins[0].symbols == ('nibble', 'fruit')
    assert labels_of(found) == [(1.0, 'nibble'), (2.0, 'fruit')]
    assert found.lessons[1].hearsay[0].label == 'nibble'
    for old, new, said in (('cup', 'mug', 'unknown symbol'), ('snack', 'fruit', 'already'), ('snack', 'skip', 'skip')):
        with pytest.raises(InputError, match=said):
            with_symbol_renamed(before, old, new)


def test_what_a_dropped_symbol_meant_is_of_none():
    """Things that the robot need not know any more are taken for something else."""
    before = taught('a', [(1, 'snack'), (2, 'fruit'), (3, 'cup')], symbols=('snack', 'fruit', 'cup'))
    judged = replace(before.lessons[2], judgements=(ViewJudgement(3, True), ViewJudgement(1, True)))
    found = without_symbol(replace(before, lessons=(*before.lessons[:2], judged)), 'cup')
    assert labels_of(found) == [(1.0, 'snack'), (2.0, 'fruit'), (3.0, 'none')]
    assert [each.matters for each in found.lessons[2].judgements] == [False, True]
    with pytest.raises(InputError, match='fewer than two'):
        without_symbol(found, 'snack')


def test_a_symbol_is_added():
    """A new word can be taught only to a robot that knows nothing."""
    assert with_symbol(taught('a', [(1, 'snack')]), 'tool').symbols == (*SYMBOLS, 'tool')
    for name in ('snack', 'none', '7'):
        with pytest.raises(InputError):
            with_symbol(taught('a', [(1, 'snack')]), name)


def followed(episode, label, teacher='anna', stamp=1, looks=(1, 2)):
    """Return knowledge of a thing that was named by its first look; the label was carried to the second."""
    first, second = ((SeenView(view, 7, (float(look),) * 2),) for view, look in enumerate(looks, start=1))
    lessons = (
        Lesson(episode, 1, stamp, first, QueryKind.LABEL, teacher, labels=(ViewLabel(1, label),)),
        Lesson(episode, 2, stamp + 1, second, labels=(ViewLabel(2, label, carried_from=1),)),
    )
    return Knowledge(
        SYMBOLS, ('colour_red', 'size_height'), Classifiers(), lessons=lessons,
        origins=(Origin(episode, SYMBOLS, teachers={teacher: TeacherCounts(1)}),),
    )  # fmt: skip


def test_carried_labels_of_two_robots_are_put_together():
    """A label would be carried from another thing's view in the file of both."""
    found, contradictions = merged(followed('a', 'snack'), followed('b', 'fruit', looks=(3, 4)))
    assert not contradictions
    assert labels_of(found) == [(1.0, 'snack'), (2.0, 'snack'), (3.0, 'fruit'), (4.0, 'fruit')]
    assert [label.carried_from for _, label in found.examples] == [None, 1, None, 3]
    assert [found.teacher_of(*example) for example in found.examples] == ['anna'] * 4
    assert labels_of(merged(followed('a', 'snack'), followed('b', 'snack'))[0]) == [(1.0, 'snack'), (2.0, 'snack')]


def test_what_was_carried_goes_with_the_label_that_does_not_count():
    """A label that was outvoted stays in all other looks of its thing."""
    found, contradictions = merged(
        followed('a', 'snack'), taught('b', [(1, 'fruit')], 'bob', stamp=2), settlement=NEWEST
    )
    assert [contradiction.kept for contradiction in contradictions] == ['fruit']
    assert labels_of(found) == [(1.0, 'fruit')]


@pytest.mark.parametrize('settlement', [NEWEST, RELIABLE])
@pytest.mark.parametrize('is_first', [True, False])
def test_what_was_said_counts_more_than_what_was_carried(settlement, is_first):
    """Nobody said the carried label of this view."""
    parts = [followed('a', 'snack', stamp=500), taught('b', [(2, 'fruit')], 'bob')]
    found, _ = merged(
        *(parts if is_first else parts[::-1]), settlement=settlement, reliabilities={'anna': 0.9, 'bob': 0.5}
    )
    assert sorted(labels_of(found)) == [(1.0, 'snack'), (2.0, 'fruit')]
    assert not any(lesson.hearsay for lesson in found.lessons)


def test_an_example_is_removed_with_what_was_carried_from_it():
    """A wrong label that was removed stays in all other looks of the thing; a copy can go alone."""
    assert labels_of(without_example(followed('a', 'snack'), 1)) == []
    assert labels_of(without_example(followed('a', 'snack'), 2)) == [(1.0, 'snack')]
    assert labels_of(with_symbol_renamed(followed('a', 'snack'), 'snack', 'nibble'))[1] == (2.0, 'nibble')


def test_a_label_cannot_be_carried_from_a_view_that_nobody_saw():
    """A damaged file ends in an error far from it."""
    known = followed('a', 'snack')
    wrong = replace(known.lessons[1], labels=(ViewLabel(2, 'snack', carried_from=9),))
    with pytest.raises(InputError, match='view 9 was not seen by then'):
        replace(known, lessons=(known.lessons[0], wrong))
