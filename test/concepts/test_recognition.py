"""Recognition: probabilities that add up to one, with none where nothing alike was taught."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial import cKDTree

from al_questioner.concepts import recognition
from al_questioner.concepts.recognition import Calibration, Evidence, Recogniser, median_spacing, recognise, weigh
from al_questioner.domain import NO_SYMBOL
from shared.concept_learners import SYMBOLS, learner, scene_of, standardised

RNG = np.random.default_rng(3)
THINGS = scene_of(RNG.normal(size=(30, 4)))
NONE = len(SYMBOLS)


def far_away(shift=20.0):
    """A thing unlike all others."""
    return np.full((1, 4), shift, dtype=np.float32)


@given(
    arrays(float, (5, 3), elements=st.floats(-20, 20)),
    arrays(float, (5, 3), elements=st.floats(0, 5) | st.just(np.inf)),
    arrays(float, 5, elements=st.floats(0, 50)),
    arrays(float, 5, elements=st.floats(0, 50) | st.just(np.inf)),
)
def test_probabilities_add_up_to_one(log_odds, examples, mattering, of_none):
    """Otherwise the number for none could not be compared with those for the symbols."""
    found = weigh(Evidence(log_odds, examples, mattering, of_none))
    assert found.shape == (5, 4)
    assert (found >= 0).all()
    np.testing.assert_allclose(found.sum(axis=1), 1, rtol=1e-12)
    surer = weigh(Evidence(log_odds + np.array([1, 0, 0]), examples, mattering, of_none))
    assert (surer[:, 0] >= found[:, 0]).all()
    nearer = weigh(Evidence(log_odds, examples * np.array([1, 0.5, 1]), mattering, of_none))
    assert (nearer[:, 1] >= found[:, 1] - 1e-12).all()


def test_the_odds_are_those_of_the_formula():
    """A wrong sign or power would still give numbers that look like probabilities."""
    calibration = Calibration(2.0, 0.5, 0.1, 0.7, 3.0)
    evidence = Evidence(np.log([[4.0, 0.25]]), np.array([[0.5, np.inf]]), np.array([1.95]), np.array([0.45]))
    odds = np.array([4.0**2 * (np.exp(-0.5) + 0.1), 0.25**2 * 0.1, 0.7 * (2.0**3 + (2.0 / 0.5) ** 3)])
    np.testing.assert_allclose(weigh(evidence, calibration)[0], odds / odds.sum())
    odds[2] = 0.7 * 2.0**3
    np.testing.assert_allclose(weigh(evidence._replace(of_none=np.array([np.inf])), calibration)[0], odds / odds.sum())


def test_what_is_unlike_all_that_was_taught_is_of_none():
    """A robot would call every new thing by the name of something."""
    concepts = learner(THINGS, labels=['snack', 'fruit', 'snack', 'fruit'], amplitude=100.0)
    assert recognise(concepts, far_away()).argmax() == NONE
    taught = recognise(concepts, THINGS.features[:4])
    assert taught.argmax(axis=1).tolist() == [0, 1, 0, 1]
    assert (taught.max(axis=1) > 0.8).all()


def test_where_nothing_was_taught_all_is_of_none():
    """Otherwise a robot would give names before it was told any."""
    found = recognise(learner(THINGS), THINGS.features)
    assert (found.argmax(axis=1) == NONE).all()
    assert np.allclose(found[:, 0], found[:, 1])


def test_examples_of_none_and_of_what_matters_are_taken_in():
    """Answers that give no name to a thing would be lost."""
    labels = ['snack', 'fruit']
    beside = THINGS.features[[2]] + 0.01
    before = recognise(learner(THINGS, labels=labels, amplitude=100.0), beside)[0, NONE]
    with_none = learner(THINGS, labels=[*labels, NO_SYMBOL], amplitude=100.0)
    assert recognise(with_none, beside)[0, NONE] > before
    judged = learner(THINGS, labels=labels, amplitude=100.0)
    judged.judge_scene(scene_of(THINGS.features[2:3], [2]), [2], 3)
    assert recognise(judged, beside)[0, NONE] < before


def test_features_that_do_not_matter_do_not_count():
    """A thing would be strange to the robot because of the noise that was told to be none of its business."""
    concepts = learner(THINGS, labels=['snack', 'fruit'])
    concepts.restrict_to_groups(['colour', 'size'])
    changed = THINGS.features[:1].copy()
    changed[0, 3] += 50
    np.testing.assert_array_equal(recognise(concepts, changed), recognise(concepts, THINGS.features[:1]))


def test_the_order_of_things_does_not_count():
    """A thing would be called otherwise when it is moved in the list."""
    concepts = learner(THINGS, labels=['snack', 'fruit', NO_SYMBOL])
    found = recognise(concepts, THINGS.features)
    np.testing.assert_allclose(recognise(concepts, THINGS.features[::-1])[::-1], found, rtol=1e-9)


def test_a_recogniser_follows_its_learner():
    """It would go on with what the learner knew when it began."""
    concepts = learner(THINGS, labels=['snack'])
    recogniser = Recogniser(concepts)
    for turn, change in enumerate(
        (
            lambda: concepts.label(5, THINGS.features[5], 'fruit', 2),
            lambda: concepts.observe(scene_of(RNG.normal(size=(20, 4)), range(100, 120))),
            lambda: concepts.judge_scene(THINGS, [0, 5, 7], 3),
            lambda: concepts.restrict_to_groups(['colour']),
        )
    ):
        before = recogniser.probabilities(THINGS.features)
        change()
        after = recogniser.probabilities(THINGS.features)
        assert not np.array_equal(before, after), turn
        np.testing.assert_array_equal(after, recognise(concepts, THINGS.features))


@pytest.mark.parametrize('count', [2, 3, 50])
def test_the_spacing_is_that_of_nearest_neighbours(count, monkeypatch):
    """Distances to itself, or to things of another part of the table, would count."""
    points = RNG.normal(size=(count, 5))
    monkeypatch.setattr(recognition, 'ROWS_AT_ONCE', 7)
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert median_spacing(points) == pytest.approx(np.median(nearest) / np.sqrt(5))


def test_things_that_all_look_alike_have_a_spacing():
    """Distances would be divided by zero."""
    assert median_spacing(np.zeros((4, 3))) == recognition.LEAST_SPACING
    assert median_spacing(np.zeros((1, 3))) == 1.0
    concepts = learner(scene_of(np.ones((3, 4))), labels=['snack'])
    assert np.isfinite(recognise(concepts, np.ones((2, 4), dtype=np.float32))).all()


def test_the_evidence_is_in_its_units():
    """Another unit would be another calibration, and every number would still look like a probability."""
    concepts = learner(THINGS, labels=['snack', 'fruit', NO_SYMBOL, 'snack'])
    points = standardised(THINGS)
    root = np.sqrt(points.shape[1])
    spacing = np.median(cKDTree(points).query(points, k=2)[0][:, 1]) / root

    def distances(rows):
        return cKDTree(points[rows]).query(points)[0] / root

    found = Recogniser(concepts).evidence(THINGS.features)
    np.testing.assert_allclose(found.examples, np.stack([distances([0, 3]), distances([1])], axis=1), atol=1e-6)
    expected = np.minimum(distances([0, 1, 3]), recognition.LARGEST_DISTANCE) / np.sqrt(spacing)
    np.testing.assert_allclose(found.mattering, expected, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(found.of_none, distances([2]) / np.sqrt(spacing), rtol=1e-5, atol=1e-6)
    q = concepts.predict_proba(THINGS.features)
    np.testing.assert_allclose(found.log_odds, np.log(q / (1 - q)))
