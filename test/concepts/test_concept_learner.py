"""Taking in answers, and their consequences for the models."""

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner, ConceptModels, Kernel, select_features
from al_questioner.domain import NO_SYMBOL, InputError, Outcome, QueryKind, QueryRecord, SceneError
from shared.concept_learners import SYMBOLS, TOLD, learner, scene_of, standardised


def test_beliefs_are_those_of_models_on_standardised_features(taught, scene):
    """The whole path: raw features, statistics of the observations, labels, models."""
    table = standardised(scene)
    expected = ConceptModels(SYMBOLS).fit(table[:3], TOLD)
    np.testing.assert_allclose(taught.predict_proba(scene.features), expected.predict_proba(table), atol=1e-10)
    np.testing.assert_allclose(taught.look_ahead(scene), expected.look_ahead(table), atol=1e-10)


def test_told_groups_are_the_only_features_in_use(taught, scene):
    """After the answer to a feature subset query the other features must not count, nor widen the kernel."""
    taught.restrict_to_groups(('size', 'colour'))
    assert taught.kernel.length_scale == pytest.approx(3**0.5)
    other = scene.features.copy()
    other[:, 3] = 1000
    np.testing.assert_array_equal(taught.predict_proba(other), taught.predict_proba(scene.features))


def test_same_view_counts_once_in_the_statistics(scene):
    """A scene that stays for ten turns is one observation of each object, not ten."""
    moved = scene_of(np.vstack([scene.features[:5], scene.features[5:] + 1]))
    once, often = (learner(*[scene] * times, moved, labels=['snack']) for times in (1, 10))
    np.testing.assert_array_equal(once.predict_proba(scene.features), often.predict_proba(scene.features))
    assert once.model_version == often.model_version == 3


def test_what_stays_beside_something_new_is_not_counted_again():
    """Otherwise on a table where half of the things stay, the statistics would lean towards those that stay longest."""
    rng = np.random.default_rng(4)
    old, new = rng.normal(size=(6, 4)), rng.normal(loc=9, size=(2, 4))
    later = scene_of(np.concatenate([old[:4], new]), object_ids=(0, 1, 2, 3, 6, 7))
    gradually = learner(scene_of(old), later, labels=['snack'])
    at_once = learner(scene_of(np.concatenate([old, new])), labels=['snack'])
    probe = rng.normal(size=(5, 4)).astype(np.float32)
    np.testing.assert_allclose(gradually.predict_proba(probe), at_once.predict_proba(probe), atol=1e-9)


@pytest.mark.parametrize('selector', [None, select_features])
def test_watched_and_unwatched_learners_agree_to_the_last_bit(selector):
    """Models follow from the events alone: a look between them must not move one digit, or ties break otherwise."""
    rng = np.random.default_rng(12)
    names = (*(f'colour_{i}' for i in range(8)), *(f'size_{i}' for i in range(4)))
    table = rng.normal(size=(7, 12))
    plain, watched = (ConceptLearner((*SYMBOLS, 'drink'), amplitude=25.0, selector=selector) for _ in range(2))

    def look(concepts):
        return [
            concepts.predict_proba(now.features),
            concepts.look_ahead(now),
            concepts.predict_after_selection(now),
            concepts.predict_proba(now.features[:2]),
        ]

    for turn in range(24):
        if turn % 6 == 0:
            table = table + rng.normal(size=table.shape) * (rng.random((7, 1)) < 0.5)
        now = scene_of(table, names=names)
        thing, symbol = int(rng.integers(7)), str(rng.choice([*SYMBOLS, 'drink', NO_SYMBOL]))
        for concepts in (plain, watched):
            concepts.observe(now)
            if concepts is watched:
                look(concepts)
            if turn == 11:
                concepts.restrict_to_groups(('colour',))
            else:
                concepts.label(thing, now.features[thing], symbol, turn)
            if concepts is watched and turn % 2:
                look(concepts)
        assert plain.model_version == watched.model_version
        if turn % 8 == 7:
            for ours, theirs in zip(look(plain), look(watched), strict=True):
                np.testing.assert_array_equal(ours, theirs)


def test_positives_do_not_count_what_belongs_to_nothing(taught):
    assert taught.positives == {'snack': 1, 'fruit': 1}


def test_labelled_views_are_recognised(taught, scene):
    """None counts as a label; a changed object, or another one that looks the same, is unlabelled."""
    assert taught.is_labelled(scene).tolist() == [True, True, True, False, False, False]
    changed = scene_of(scene.features + np.array([[0], [2], [0], [0], [0], [0]]), object_ids=(0, 1, 9, 3, 4, 5))
    assert taught.is_labelled(changed).tolist() == [True, False, False, False, False, False]
    taught.label(0, scene.features[0], 'snack', turn=4)
    assert taught.times_labelled(scene).tolist() == [2, 1, 1, 0, 0, 0]


def test_labels_of_a_view_are_counted(taught, scene):
    """Only labels of this object count, and only those of how it looks now."""
    taught.label(1, scene.features[1], 'fruit', turn=4)
    taught.label(1, scene.features[3], 'fruit', turn=5)
    taught.label(9, scene.features[3], 'fruit', turn=6)
    assert taught.times_labelled(scene).tolist() == [1, 2, 1, 0, 0, 0]


def test_view_tolerance_forgives_the_noise_of_a_camera(scene):
    """Tolerances are in standard deviations of the features."""
    noisy = scene_of(scene.features + 0.05 * scene.features.std(axis=0))
    for tolerance, same in ((0.0, False), (0.2, True)):
        concepts = learner(scene, labels=['snack'], view_tolerance=tolerance)
        assert concepts.is_labelled(noisy)[0] == same
        assert concepts.is_unchanged(scene, noisy) == same


def test_order_of_objects_is_no_change(taught, scene):
    backwards = scene_of(scene.features[::-1], object_ids=scene.object_ids[::-1])
    assert taught.is_unchanged(scene, backwards)
    assert not taught.is_unchanged(scene, scene_of(scene.features[:5]))


def test_computational_selection_follows_the_labels(scene):
    """All features until the labels allow a test, then those that tell the labels apart."""
    rng = np.random.default_rng(4)
    names = tuple(f'noise_{i}' for i in range(30))
    table = rng.normal(size=(8, 30))
    table[:, 7] = [0, 0, 0, 0, 9, 9, 9, 9]
    many = scene_of(table, names=names)
    concepts = learner(many, selector=select_features)
    for i, symbol in [(0, 'snack'), (4, 'fruit')]:
        concepts.label(i, many.features[i], symbol, 1)
    assert concepts.kernel.length_scale == pytest.approx(30**0.5)
    concepts.label(1, many.features[1], 'snack', 2)
    assert concepts.kernel.length_scale < 15**0.5
    other = many.features[:1].copy()
    other[:, 7] = 9
    assert not np.array_equal(concepts.predict_proba(other), concepts.predict_proba(many.features[:1]))


def test_distance_to_the_nearest_labelled_view(taught, scene):
    """Root mean square in standard deviations, over the features in use."""
    taught.restrict_to_groups(('size',))
    height = scene.features[:, 2].astype(np.float64)
    expected = np.abs(height[:, None] - height[None, :3]).min(axis=1) / height.std()
    np.testing.assert_allclose(taught.distance_to_labelled(scene), expected, atol=1e-12)
    assert (learner(scene).distance_to_labelled(scene) == 0).all()


def test_another_feature_layout_is_refused_and_changes_nothing(taught, scene):
    before, version = taught.predict_proba(scene.features), taught.model_version
    with pytest.raises(SceneError, match="feature 1 of the scene is 'colour_blue', it was 'colour_green'"):
        taught.observe(scene_of(scene.features, names=('colour_red', 'colour_blue', 'size_height', 'noise_max')))
    assert taught.model_version == version
    np.testing.assert_array_equal(taught.predict_proba(scene.features), before)


def test_what_cannot_be_told(taught, scene):
    for features, label, reason in (
        (scene.features[0], 'pizza', "unknown label 'pizza'"),
        (scene.features[0, :2], 'snack', 'expected'),
        (np.full(4, np.nan), 'snack', 'not all finite'),
    ):
        with pytest.raises(InputError, match=reason):
            taught.label(0, features, label, 1)
    with pytest.raises(InputError, match="unknown feature group 'taste'"):
        taught.restrict_to_groups(('size', 'taste'))
    gone = QueryRecord(1, QueryKind.LABEL, 99, 'snack', 1.0, Outcome.ANSWERED)
    with pytest.raises(InputError, match='object 99 is not in the scene'):
        taught.learn(gone, scene)
    with pytest.raises(InputError, match='view_tolerance'):
        ConceptLearner(SYMBOLS, 4.0, view_tolerance=-1)


def test_tuned_kernel_is_that_of_the_labels_and_used_everywhere(taught, scene):
    """Otherwise predictions, look-ahead and the imagined feature subset would follow different kernels."""
    untuned = taught.predict_proba(scene.features)
    version = taught.model_version
    assert taught.kernel == Kernel(4.0, 2.0)
    assert taught.repeat_tuning()
    assert taught.model_version == version + 1
    assert taught.kernel != Kernel(4.0, 2.0)
    assert not np.allclose(taught.predict_proba(scene.features), untuned, atol=1e-4)
    table = standardised(scene)
    expected = ConceptModels(SYMBOLS, taught.kernel.amplitude, taught.kernel.length_scale).fit(table[:3], TOLD)
    np.testing.assert_allclose(taught.predict_proba(scene.features), expected.predict_proba(table), atol=1e-10)
    np.testing.assert_allclose(taught.look_ahead(scene), expected.look_ahead(table), atol=1e-9)
    # Three labels, all different, allow no selection: the imagined subset is all features.
    np.testing.assert_allclose(taught.predict_after_selection(scene), expected.predict_proba(table), atol=1e-10)


def test_tuned_length_scale_follows_the_number_of_features(taught):
    """Otherwise after a feature subset query the kernel would be far too wide for the few features that are left."""
    taught.repeat_tuning()
    before = taught.kernel
    taught.restrict_to_groups(('size',))
    assert taught.kernel.amplitude == before.amplitude
    assert taught.kernel.length_scale == pytest.approx(before.length_scale / 2)


def test_events_after_tuning_keep_the_tuned_kernel_on_any_features():
    """Otherwise labels would join a kernel matrix of other hyperparameters, or subsets use too wide a kernel."""
    table = np.random.default_rng(4).normal(size=(8, 30))
    table[:, 7] = [0, 9, 0, 9, 0, 9, 0, 9]
    many = scene_of(table, names=tuple(f'{"colour" if i < 10 else "noise"}_{i}' for i in range(30)))
    labels = ['snack', 'fruit', 'snack', 'fruit', 'snack']
    concepts = learner(many)
    for i, label in enumerate(labels):
        if i == 3:
            assert concepts.repeat_tuning()
        concepts.label(i, many.features[i], label, i)
    points = standardised(many)
    kernel, chosen = concepts.kernel, select_features(points[:5], labels)
    assert 0 < chosen.sum() < 15

    def expected(features):
        models = ConceptModels(SYMBOLS, kernel.amplitude, kernel.length_scale * np.sqrt(features.shape[1] / 30))
        return models.fit(features[:5], labels).predict_proba(features)

    np.testing.assert_allclose(concepts.predict_proba(many.features), expected(points), atol=1e-8)
    np.testing.assert_allclose(concepts.predict_after_selection(many), expected(points[:, chosen]), atol=1e-8)
    concepts.restrict_to_groups(('colour',))
    np.testing.assert_allclose(concepts.predict_proba(many.features), expected(points[:, :10]), atol=1e-8)


def test_tuning_again_without_news_changes_nothing(taught):
    """Otherwise the kernel would drift with every call, and the version would tell of models that are not new."""
    assert taught.repeat_tuning()
    kernel, version = taught.kernel, taught.model_version
    assert not taught.repeat_tuning()
    assert (taught.kernel, taught.model_version) == (kernel, version)


def test_tuning_without_labels_keeps_the_configured_kernel(scene):
    """Otherwise a robot that has been told nothing would change its mind."""
    concepts = ConceptLearner(SYMBOLS, 9.0, 5.0)
    assert not concepts.repeat_tuning(), 'not even a scene'
    concepts.observe(scene)
    assert not concepts.repeat_tuning()
    assert (concepts.kernel, concepts.model_version) == (Kernel(9.0, 5.0), 1)


def test_tuning_moves_from_the_length_scale_that_was_configured(scene):
    """Otherwise a user's length scale would be forgotten at the first tuning."""
    concepts = learner(scene, labels=['snack'], length_scale=40.0)
    concepts.repeat_tuning()
    assert 20 <= concepts.kernel.length_scale <= 80


def test_labels_of_a_scene_at_once_are_labels_one_by_one(scene):
    """Otherwise the ceiling that is told everything would know something else than a learner that asked for it."""
    said = {0: 'snack', 3: 'fruit', 5: NO_SYMBOL}
    at_once, one_by_one = learner(scene), learner(scene)
    at_once.label_scene(scene, said, turn=4)
    for object_id, symbol in said.items():
        one_by_one.label(object_id, scene.features[object_id], symbol, 4)
    assert [(v.object_id, v.label, v.turn) for v in at_once.labelled_views] == [(*each, 4) for each in said.items()]
    expected = one_by_one.predict_proba(scene.features)
    np.testing.assert_allclose(at_once.predict_proba(scene.features), expected, atol=1e-9)
    for wrong, reason in (({0: 'drink'}, 'unknown label'), ({0: 'snack', 77: 'snack'}, 'object 77')):
        with pytest.raises(InputError, match=reason):
            at_once.label_scene(scene, wrong, 5)
    assert len(at_once.labelled_views) == 3


def test_predictions_after_labels_are_those_of_having_learnt_each(taught, scene):
    """Otherwise the oracle would weigh labels by what they do not lead to, or teach the learner what nobody told it."""
    taught.restrict_to_groups(('colour', 'size'))
    before = taught.predict_proba(scene.features)
    rows, symbols = [4, 5, 3], ['snack', NO_SYMBOL, 'fruit']
    foreseen = taught.predict_after_each(scene.features[rows], symbols, scene.features)
    np.testing.assert_array_equal(taught.predict_proba(scene.features), before)
    for row, symbol, after in zip(rows, symbols, foreseen, strict=True):
        oracle = learner(scene, labels=TOLD)
        oracle.restrict_to_groups(('colour', 'size'))
        oracle.label(row, scene.features[row], symbol, 5)
        np.testing.assert_allclose(after, oracle.predict_proba(scene.features), atol=8e-7)
