"""Views that were named, judged or could not be named: the last word about each counts."""

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, InputError, Outcome, QueryKind, QueryRecord
from shared.concept_learners import TOLD, learner, scene_of, standardised


def test_what_does_not_matter_is_of_no_symbol(taught, scene):
    """Otherwise an answer about forty things would teach nothing; or it would contradict what was said of one."""
    version, before = taught.model_version, len(taught.labelled_views)
    taught.judge_scene(scene, (1, 4), turn=7)
    assert taught.model_version == version + 1
    assert [(view.object_id, view.label, view.turn) for view in taught.labelled_views[before:]] == [
        (3, NO_SYMBOL, 7), (5, NO_SYMBOL, 7),
    ]  # fmt: skip
    assert taught.labels_of(scene) == ('snack', 'fruit', NO_SYMBOL, NO_SYMBOL, None, NO_SYMBOL)
    assert [view.matters for view in taught.judged_views] == [False, True, False, False, True, False]
    # The labelled one needs no such word.
    assert taught.matters(scene).tolist() == [False, False, False, False, True, False]
    oracle = learner(scene, labels=TOLD)
    oracle.label_scene(scene, {3: NO_SYMBOL, 5: NO_SYMBOL}, 7)
    np.testing.assert_array_equal(taught.predict_proba(scene.features), oracle.predict_proba(scene.features))


def test_where_everything_matters_or_is_known_no_model_changes(scene):
    """Otherwise what is computed from the models would be computed again for nothing."""
    concepts = learner(scene)
    version = concepts.model_version
    concepts.judge_scene(scene, range(6), turn=1)
    assert concepts.model_version == version
    assert concepts.matters(scene).all()
    assert not concepts.is_labelled(scene).any()
    concepts.judge_scene(scene, (), turn=2)
    assert concepts.is_labelled(scene).all()
    assert not concepts.matters(scene).any()


def test_what_matters_is_known_of_a_view_and_not_of_a_thing_that_has_changed(scene):
    """A box that is known to matter says nothing of what it is seen as once it looks different."""
    concepts = learner(scene)
    concepts.judge_scene(scene, (0, 2), turn=1)
    moved = scene.features.copy()
    moved[0] += 9
    assert concepts.matters(scene_of(moved)).tolist() == [False, False, True, False, False, False]
    concepts.judge_scene(scene_of(moved[:1]), (), turn=2)
    assert concepts.matters(scene).tolist() == [True, False, True, False, False, False]


def test_a_thing_that_was_forgotten_first_matters_once_it_is_named(taught, scene):
    """The last answer counts: otherwise one omission would make it a thing of no symbol for ever."""
    taught.judge_scene(scene, (1,), turn=7)
    assert taught.labels_of(scene)[4] == NO_SYMBOL
    taught.judge_scene(scene, (1, 4), turn=8)
    assert taught.labels_of(scene) == ('snack', 'fruit', NO_SYMBOL, NO_SYMBOL, None, NO_SYMBOL)
    assert taught.matters(scene).tolist() == [False, False, False, False, True, False]
    oracle = learner(scene, labels=TOLD)
    oracle.label_scene(scene, {3: NO_SYMBOL, 5: NO_SYMBOL}, 7)
    np.testing.assert_allclose(taught.predict_proba(scene.features), oracle.predict_proba(scene.features), atol=1e-8)


def test_a_label_none_of_its_own_is_not_taken_back_by_a_later_judgement(taught, scene):
    """A word about the thing itself counts more than one about many."""
    taught.label(4, scene.features[4], NO_SYMBOL, 7)
    taught.judge_scene(scene, (4,), turn=8)
    assert taught.labels_of(scene)[4] == NO_SYMBOL


def test_what_was_taken_back_is_no_longer_near(scene):
    """A false alarm would make all that looks like it seem to be of some symbol."""
    concepts = learner(scene)
    concepts.judge_scene(scene, (1, 4), turn=1)
    concepts.label(4, scene.features[4], NO_SYMBOL, 2)
    assert concepts.distances_to_mattering(scene).shape == (6, 1)
    concepts.judge_scene(scene, (), turn=3)
    assert concepts.distances_to_mattering(scene).shape == (6, 0)


def test_distances_to_what_matters(scene):
    """Beliefs in later scenes depend on them."""
    concepts = learner(scene)
    assert concepts.distances_to_mattering(scene).shape == (6, 0)
    concepts.judge_scene(scene, (4, 1), turn=1)
    table = standardised(scene)
    expected = np.sqrt(np.mean((table[:, None] - table[[1, 4]][None]) ** 2, axis=2))
    np.testing.assert_allclose(concepts.distances_to_mattering(scene), expected, atol=1e-6)


def test_a_thing_that_is_not_there_does_not_matter(taught, scene):
    """And nothing was learnt when it is refused."""
    with pytest.raises(InputError, match='object 99 is not in the scene'):
        taught.judge_scene(scene, (1, 99), turn=7)
    assert not taught.judged_views


def test_the_record_of_a_relevance_query_is_learnt(taught, scene):
    """Also where nothing matters; and nothing is learnt without an answer."""

    def record(objects, outcome=Outcome.ANSWERED):
        return QueryRecord(7, QueryKind.RELEVANCE, None, None, 4.0, outcome, objects=objects)

    taught.learn(record(None, Outcome.UNKNOWN), scene)
    assert not taught.judged_views
    taught.learn(record((4,)), scene)
    assert taught.matters(scene).tolist() == [False] * 4 + [True, False]
    taught.learn(record(()), scene)
    assert taught.is_labelled(scene).all()
