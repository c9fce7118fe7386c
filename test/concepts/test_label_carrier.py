"""Labels that follow an object to its other views: what is carried, and what takes it back."""

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL
from shared.concept_learners import learner, scene_of

LOOKS = {name: 3.0 * np.eye(4)[i] + i for i, name in enumerate('ABC')}
"""Three looks of the object 7, far from each other; two others stand beside it."""
OTHERS = [[0.0, 9, 0, 4], [5.0, 0, 9, 9]]


def table(look):
    return scene_of([LOOKS[look], *OTHERS], (7, 1, 2))


class Taught:
    """A learner that carries labels, and its turns."""

    def __init__(self, carries=True):
        self.concepts = learner()
        if carries:
            self.concepts.carry_labels()
        self.turn = 0

    def see(self, *looks):
        for look in looks:
            self.turn += 1
            self.scene = table(look)
            self.concepts.observe(self.scene, self.turn)
        return self

    def name(self, label, object_id=7):
        row = self.scene.object_ids.index(object_id)
        self.concepts.label(object_id, self.scene.features[row], label, self.turn)
        return self

    def judge(self, *mattering):
        self.concepts.judge_scene(self.scene, mattering, self.turn)
        return self

    @property
    def labels(self):
        """Labels of object 7 by its looks; one that was carried in brackets."""
        found = {}
        for view in self.concepts.labelled_views:
            if view.object_id == 7:
                (look,) = [name for name, features in LOOKS.items() if np.allclose(features, view.features)]
                found.setdefault(look, []).append(f'({view.label})' if view.is_carried else view.label)
        return {look: ', '.join(labels) for look, labels in found.items()}


@pytest.fixture
def taught():
    return Taught()


def test_a_label_counts_for_views_that_come_later(taught):
    """The pasta in the pot is asked about, although it was named in the box."""
    taught.see('A').name('snack').see('B')
    assert taught.labels == {'A': 'snack', 'B': '(snack)'}
    assert taught.concepts.is_labelled(taught.scene).tolist() == [True, False, False]
    assert taught.see('C', 'A', 'B').labels == {'A': 'snack', 'B': '(snack)', 'C': '(snack)'}
    assert [view.turn for view in taught.concepts.labelled_views] == [1, 2, 3]


def test_a_label_counts_for_views_that_were_seen_before(taught):
    """A thing that is named in the pot is not known in the box, where it was seen before."""
    taught.see('A', 'B', 'C').name('fruit')
    assert taught.labels == {'C': 'fruit', 'A': '(fruit)', 'B': '(fruit)'}
    assert taught.concepts.positives == {'snack': 0, 'fruit': 3}


def test_the_models_are_those_of_a_teacher_who_named_every_view(taught):
    """A carried label is worth less, or more, than one that was given."""
    taught.see('A').name('snack').name('fruit', 1).see('B')
    told = Taught(carries=False).see('A').name('snack').name('fruit', 1).see('B').name('snack')
    np.testing.assert_allclose(
        taught.concepts.predict_proba(taught.scene.features),
        told.concepts.predict_proba(told.scene.features),
        atol=1e-9,
    )
    assert taught.concepts.model_version == told.concepts.model_version - 1


def test_nothing_is_carried_unless_it_is_wanted():
    """A label would go to another thing if perception gives ids to other things."""
    assert Taught(carries=False).see('A').name('snack').see('B').labels == {'A': 'snack'}


def test_a_thing_of_no_symbol_stays_one(taught):
    """Clutter is asked about with every new look."""
    assert taught.see('A').name(NO_SYMBOL).see('B').labels == {'A': NO_SYMBOL, 'B': f'({NO_SYMBOL})'}


def test_what_did_not_matter_does_not_matter_later(taught):
    """Half of the worth of a question about forty things is gone with the next look at them."""
    taught.see('A', 'B').judge(1).see('C')
    assert taught.labels == {'B': NO_SYMBOL, 'A': f'({NO_SYMBOL})', 'C': f'({NO_SYMBOL})'}


def test_what_matters_after_all_takes_back_what_was_carried(taught):
    """A thing that was forgotten once stays an example of none by its other looks."""
    taught.see('A').judge(1).see('B').judge(7)
    assert taught.labels == {'A': NO_SYMBOL}
    assert taught.concepts.matters(taught.scene)[0]
    # From now on nothing is known of the thing; and what comes between the two answers stays open.
    assert taught.see('C').labels == {'A': NO_SYMBOL}
    assert taught.name('snack').see('B').labels == {'A': NO_SYMBOL, 'C': 'snack', 'B': '(snack)'}


def test_a_name_counts_more_than_what_was_left_out(taught):
    """A thing that a teacher forgot in a list of forty loses its name."""
    taught.see('A').name('snack').see('B').judge(1)
    assert taught.labels == {'A': 'snack', 'B': '(snack)'}


def test_what_was_said_to_matter_is_not_made_none_by_another_view(taught):
    """A word about the view itself counts more than one about another view."""
    taught.see('A').judge(7).see('B').name(NO_SYMBOL).see('A')
    assert taught.labels == {'B': NO_SYMBOL}
    assert taught.concepts.matters(taught.scene)[0]


def test_the_newest_answer_governs_from_then_on(taught):
    """A thing that got the id of another one is called by the wrong name for ever."""
    taught.see('A').name('snack').see('B', 'C').name('fruit')
    # B came between the two: it could be either.
    assert taught.labels == {'A': 'snack', 'C': 'fruit'}
    assert not taught.see('A').concepts.is_labelled(scene_of([LOOKS['B']], (7,))).any()
    assert taught.see('B').labels == {'A': 'snack', 'C': 'fruit', 'B': '(fruit)'}


def test_after_a_contradiction_nothing_is_carried_back(taught):
    """A view from before the id went over to another thing gets the name of that one."""
    taught.see('A').name('snack').see('B').name('fruit').see('C', 'A').name('fruit')
    assert taught.labels == {'B': 'fruit', 'C': '(fruit)', 'A': 'snack, fruit'}
    again = Taught().see('A').name('snack').see('B', 'C').name('fruit').name('fruit')
    assert again.labels == {'A': 'snack', 'C': 'fruit, fruit'}


def test_an_answer_takes_the_place_of_what_was_carried(taught):
    """A view that is asked about again counts twice, once for a word that nobody said of it."""
    taught.see('A').name('snack').see('B').name('snack')
    assert taught.labels == {'A': 'snack', 'B': 'snack'}
    assert [(gone.view.label, gone.turn) for gone in taught.concepts.withdrawn_views] == [('snack', 2)]


def test_things_do_not_get_the_labels_of_others(taught):
    """Labels are carried by the place in the scene, or to all."""
    taught.see('A').name('fruit', 1).see('B')
    assert taught.labels == {}
    assert len(taught.concepts.labelled_views) == 1


def test_a_thing_that_vanished_keeps_its_name(taught):
    """A thing that was behind another one for a while is asked about again."""
    taught.see('A').name('snack')
    taught.concepts.observe(scene_of(OTHERS, (1, 2)), 2)
    taught.turn = 2
    assert taught.see('B').labels == {'A': 'snack', 'B': '(snack)'}


def test_small_differences_are_no_other_view():
    """The noise of a sensor fills the memory with copies of the same example."""
    concepts = learner(view_tolerance=0.3)
    concepts.carry_labels()
    rng = np.random.default_rng(0)
    for turn in range(1, 30):
        scene = scene_of(np.array([LOOKS['A'], *OTHERS]) + rng.normal(0, 0.05, (3, 4)), (7, 1, 2))
        concepts.observe(scene, turn)
        if turn in (2, 20):
            concepts.label(7, scene.features[0], 'snack', turn)
    assert len(concepts.labelled_views) == 2
