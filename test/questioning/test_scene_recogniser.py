"""A robot that was taught tells what it sees, says where it does not know, and finds what is wanted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from al_questioner.concepts.recognition import Recogniser, recognise
from al_questioner.domain import (
    DEFAULT_CLASSIFIERS,
    NO_SYMBOL,
    Classifiers,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    Recognition,
    Scene,
    SeenView,
    SettingsError,
    ViewLabel,
)
from al_questioner.questioning import SceneRecogniser
from al_questioner.questioning.review import taught_learner
from al_questioner.questioning.scene_recogniser import recognise_scene

NAMES = ('colour_red', 'size_height')
SYMBOLS = ('main_dish', 'snack')
PLACES = {'main_dish': (0, 0), 'snack': (10, 0), NO_SYMBOL: (0, 10)}


def knowledge(labels=('main_dish', 'snack', NO_SYMBOL) * 3, symbols=SYMBOLS, names=NAMES) -> Knowledge:
    """Return what was taught of things in three clusters, one lesson an example."""
    rng = np.random.default_rng(1)
    lessons = []
    for number, label in enumerate(labels, start=1):
        look = np.array(PLACES[label]) + rng.normal(scale=0.3, size=2)
        view = SeenView(number, number, tuple(look.astype(np.float32).tolist()))
        lessons.append(Lesson('day', number, seen=(view,), labels=(ViewLabel(number, label),)))
    return Knowledge(symbols, names, DEFAULT_CLASSIFIERS, lessons=tuple(lessons), origins=(Origin('day', symbols),))


def scene(*looks, ids=None, names=NAMES) -> Scene:
    """Return things with these looks, one metre from each other."""
    table = np.array(looks, dtype=np.float32).reshape(len(looks), len(names))
    ids = tuple(range(20, 20 + len(table))) if ids is None else ids
    return Scene(ids, np.array([[i, 0, 0.5] for i in range(len(table))], dtype=np.float32).reshape(-1, 3), table, names)


LOOKS = ((0, 0), (10, 0), (0, 10), (9, 1))


def taught(threshold=0.5, **changes) -> SceneRecogniser:
    recogniser = SceneRecogniser(threshold)
    recogniser.follow(knowledge(**changes))
    return recogniser


def looked(recogniser: SceneRecogniser, seen: Scene) -> Recognition:
    found = recogniser.look(seen)
    assert found is not None
    assert recogniser.recognition == found
    return found


def test_every_thing_gets_the_probabilities_that_a_learner_of_the_same_has() -> None:
    """Otherwise the robot would believe two things at once."""
    recogniser, seen = taught(), scene(*LOOKS)
    found = looked(recogniser, seen)
    learner = taught_learner(knowledge())
    assert recogniser.concepts is not None
    assert np.array_equal(recogniser.concepts.predict_proba(seen.features), learner.predict_proba(seen.features))
    assert [list(each.probabilities) for each in found.things] == recognise(learner, seen.features).tolist()
    assert (found.symbols, found.examples) == (SYMBOLS, 9)
    for row, each in enumerate(found.things):
        assert (each.object_id, each.position) == (20 + row, (row, 0.0, 0.5))
        assert sum(each.probabilities) == pytest.approx(1)
        assert each.probability == max(each.probabilities)
        assert each.best == (*SYMBOLS, NO_SYMBOL)[each.probabilities.index(each.probability)]
    assert [each.best for each in found.things[:2]] == ['main_dish', 'snack']


@pytest.mark.parametrize('threshold', [0.0, 0.5, 1.0])
def test_the_threshold_decides_between_a_name_and_the_question_to_ask(threshold: float) -> None:
    """A robot that names everything is wrong where it should ask."""
    for each in looked(taught(threshold), scene(*LOOKS, (5, 5), (40, -40))).things:
        assert each.is_known is (each.probability >= threshold)
        assert each.question == ('' if each.is_known else f'What is object {each.object_id}?')


def test_the_threshold_itself_is_enough() -> None:
    """A thing would be named that is not fetched, or the other way round."""
    first = looked(taught(), scene((10, 0))).things[0]
    recogniser = taught(first.probability)
    assert looked(recogniser, scene((10, 0))).things[0].is_known
    target = recogniser.find('snack').target
    assert target is not None
    assert target.probability == first.probability


@pytest.mark.parametrize('changes', [{'classifiers': Classifiers(9.0, 'rbf', 0.0)}, {'length_scale': 0.5}])
def test_other_classifiers_are_followed_from_the_beginning(changes: dict[str, Any]) -> None:
    """Another episode may have another kernel; what was learnt with the old one would stay as it was."""
    recogniser, other = taught(), replace(knowledge(), **changes)
    recogniser.follow(other)
    seen = scene(*LOOKS)
    found = looked(recogniser, seen)
    expected = recognise(taught_learner(other), seen.features).tolist()
    assert [list(each.probabilities) for each in found.things] == expected


def test_a_symbol_that_is_new_is_followed() -> None:
    """A person would be told of a robot that was just taught what a tool is that it knows of none."""
    recogniser = taught()
    recogniser.follow(replace(knowledge(), symbols=(*SYMBOLS, 'tool')))
    found = looked(recogniser, scene(*LOOKS))
    assert found.symbols == (*SYMBOLS, 'tool')
    assert len(found.things[0].probabilities) == 4


def test_nothing_is_known_before_anything_was_taught() -> None:
    """All things look unlike what was taught then, and would be named `none` with great certainty."""
    seen = knowledge()
    untaught = taught_learner(replace(seen, lessons=tuple(replace(each, labels=()) for each in seen.lessons)))
    found = recognise_scene(Recogniser(untaught), scene(*LOOKS))
    assert found.examples == 0
    assert not any(each.is_known for each in found.things)


def test_more_lessons_are_followed_one_by_one() -> None:
    """A learner that goes on is followed without learning all again, and to the last bit."""
    recogniser, labels = SceneRecogniser(), ('main_dish', 'snack', NO_SYMBOL, 'snack')
    seen, learners = scene(*LOOKS), []
    for count in range(1, len(labels) + 1):
        recogniser.follow(knowledge(labels[:count]))
        assert recogniser.recognition is None, 'what was seen before is to be looked at again'
        found = looked(recogniser, seen)
        learner = taught_learner(knowledge(labels[:count]))
        assert [list(each.probabilities) for each in found.things] == recognise(learner, seen.features).tolist()
        learners.append(recogniser.concepts)
    assert all(each is learners[0] for each in learners)


@pytest.mark.parametrize(
    'text',
    ['snack', 'Snack', ' SNACK\n', 'the snack', 'The snack.', 'a snack', 'Some snack!', 'my snack', 'ｓｎａｃｋ'],
)
def test_plain_words_are_understood(text: str) -> None:
    """Otherwise a person would have to know how symbols are spelt."""
    recogniser = taught()
    looked(recogniser, scene(*LOOKS))
    assert recogniser.find(text).symbol == 'snack'
    assert recogniser.find(text).wanted == text
    assert recogniser.find('The main dish').symbol == 'main_dish'


@pytest.mark.parametrize(
    ('text', 'reason'),
    [
        ('snak', "'snak' is nothing that was taught; did you mean snack?; known: main_dish, snack"),
        ('', "'' is nothing that was taught; known: main_dish, snack"),
        ('the', "'the' is nothing that was taught; known: main_dish, snack"),
        ('none', "'none' is nothing that was taught; known: main_dish, snack"),
        ('x' * 100_000, 'is nothing that was taught'),
    ],
)
def test_other_words_are_refused_with_the_choices(text: str, reason: str) -> None:
    """Otherwise a person would wait for a robot that has not understood."""
    recogniser = taught()
    looked(recogniser, scene(*LOOKS))
    found = recogniser.find(text)
    assert reason in found.reason
    assert (found.symbol, found.target, found.runner_up) == (None, None, None)
    assert len(found.reason) < 200


def test_a_word_that_means_two_symbols_is_to_be_written_exactly() -> None:
    recogniser = taught(labels=(NO_SYMBOL,), symbols=('cup', 'Cup'))
    assert recogniser.find('CUP').reason == "'CUP' could be cup or Cup: write it exactly so"
    assert recogniser.find('Cup').symbol == 'Cup'


def test_the_most_probable_thing_is_found_with_the_runner_up() -> None:
    """Otherwise a manipulator would fetch another thing than what is most likely wanted."""
    recogniser = taught(0.0)
    found = looked(recogniser, scene(*LOOKS))
    column = [each.probabilities[1] for each in found.things]
    finding = recogniser.find('snack')
    best, second = sorted(range(len(column)), key=column.__getitem__, reverse=True)[:2]
    assert finding.target is not None
    assert finding.runner_up is not None
    assert (finding.target.object_id, finding.target.probability) == (20 + best, column[best])
    assert (finding.runner_up.object_id, finding.runner_up.probability) == (20 + second, column[second])
    assert finding.target.position == found.things[best].position
    assert finding.reason == ''
    assert finding.text.startswith(f'Object {20 + best} is snack with a probability of ')


def test_a_single_thing_has_no_runner_up() -> None:
    recogniser = taught(0.0)
    looked(recogniser, scene((10, 0)))
    finding = recogniser.find('snack')
    assert finding.target is not None
    assert finding.runner_up is None
    assert finding.text.endswith('; nothing else is in view.')


def test_what_is_too_improbable_is_not_fetched_but_named() -> None:
    """The person may want it all the same, and can point at it."""
    recogniser = taught(1.0)
    looked(recogniser, scene(*LOOKS))
    finding = recogniser.find('snack')
    assert finding.target is None
    assert finding.runner_up is not None
    assert finding.runner_up.object_id in (21, 23)
    told = 'nothing in view is snack with a probability of 1 or more; the most probable one is object'
    assert finding.reason.startswith(told)
    assert finding.text.startswith('Nothing in view is snack')


def test_it_is_said_why_nothing_can_be_found() -> None:
    """Otherwise a person could not tell a robot that has learnt nothing from one that sees nothing."""
    recogniser = SceneRecogniser(0.0)
    assert recogniser.find('snack').reason == 'nothing has been taught yet'
    assert recogniser.look(scene(*LOOKS)) is None
    recogniser.follow(knowledge(()))
    assert recogniser.look(scene(*LOOKS)) is None
    assert recogniser.find('snack').reason == 'nothing has been taught yet'
    recogniser.follow(knowledge())
    assert recogniser.find('snack').reason == 'no objects have been seen yet'
    assert looked(recogniser, scene()).things == ()
    assert recogniser.find('snack').reason == 'there is nothing in view'
    with pytest.raises(
        InputError, match='the concepts are of other features: they lack weight_kg and have size_height'
    ):
        recogniser.look(scene(*LOOKS, names=('colour_red', 'weight_kg')))
    assert 'they lack weight_kg' in recogniser.find('snack').reason
    looked(recogniser, scene(*LOOKS))
    assert recogniser.find('snack').target is not None


@pytest.mark.parametrize('threshold', [-0.1, 1.1, float('nan')])
def test_a_threshold_is_a_probability(threshold: float) -> None:
    with pytest.raises(SettingsError, match='threshold'):
        SceneRecogniser(threshold)


def test_what_is_rather_something_else_is_no_target() -> None:
    """With a low threshold, the robot would fetch a thing that it calls by another name."""
    recogniser = taught(0.0)
    (thing,) = looked(recogniser, scene(LOOKS[0])).things
    other = next(symbol for symbol in ('snack', 'fruit') if symbol != thing.best)
    finding = recogniser.find(other)
    assert finding.target is None
    assert f'but is rather {thing.best}' in finding.reason
