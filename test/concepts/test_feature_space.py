"""The space in which views are compared: which features count, in which unit, and what is the same view."""

import numpy as np
import pytest

from al_questioner.concepts import select_features
from al_questioner.concepts.feature_space import FeatureSpace
from al_questioner.domain import InputError, SceneError
from shared.concept_learners import scene_of, standardised


def space_of(scene, **options):
    """Return the space of a scene that was seen once."""
    space = FeatureSpace(**options)
    space.admit(scene)
    space.standardiser.update(scene.features)
    return space


def test_before_the_first_scene_there_are_no_features(scene):
    """A robot that has seen nothing would judge readings, or refuse the first table it sees."""
    space = FeatureSpace()
    assert (space.names, space.groups, space.names_in_use, space.groups_in_use) == ((), (), (), [])
    assert not space.are_implausible(scene).any()
    assert space.implausible_readings(scene) == []
    space.check(scene)
    assert space.names == ()


def test_the_first_scene_decides_which_features_there_are(scene):
    """Features of another sensor would be standardised with the statistics of this one."""
    space = space_of(scene)
    assert space.names == space.names_in_use == scene.feature_names
    assert space.groups == ('colour', 'size', 'noise')
    other = scene_of(scene.features, names=('colour_red', 'colour_blue', 'size_height', 'noise_max'))
    for refuse in (space.check, space.admit):
        with pytest.raises(SceneError, match="feature 1 of the scene is 'colour_blue', it was 'colour_green'"):
            refuse(other)
        with pytest.raises(SceneError, match='has 1 features, those before had 4'):
            refuse(scene_of([[1.0]], names=('size_height',)))


def test_told_groups_count_from_the_next_selection_on(scene):
    """Otherwise the models would be asked about features that they were not fitted to."""
    space = space_of(scene)
    assert not space.subset_was_told
    space.restrict_to_groups(('size', 'colour'))
    assert space.subset_was_told
    assert space.names_in_use == scene.feature_names
    space.select(space.table_of([]), [])
    assert space.names_in_use == ('colour_red', 'colour_green', 'size_height')
    assert space.groups_in_use == ['colour', 'colour', 'size']
    np.testing.assert_allclose(space.points_of(scene.features), standardised(scene)[:, :3], atol=1e-12)


def test_unknown_groups_are_refused_and_change_nothing(scene):
    """A word that was misheard would leave no feature in use."""
    space = space_of(scene)
    for groups, reason in (
        (('size', 'taste'), "unknown feature group 'taste'; known: colour, size, noise"),
        ((), 'no feature group'),
    ):
        with pytest.raises(InputError, match=reason):
            space.restrict_to_groups(groups)
    assert not space.subset_was_told


def test_a_selector_selects_among_what_was_told(scene):
    """Otherwise a computational selection would bring back what the teacher has ruled out."""

    def last(features, labels):
        return np.arange(features.shape[1]) == features.shape[1] - 1

    space = space_of(scene, selector=last)
    space.select(scene.features[:2], ['a', 'b'])
    assert space.names_in_use == ('noise_max',)
    space.restrict_to_groups(('colour',))
    space.select(scene.features[:2], ['a', 'b'])
    assert space.names_in_use == ('colour_green',)


def test_an_imagined_selection_is_of_all_features_and_leaves_the_space_alone(scene):
    """A question that was only thought of would change what counts."""
    space = space_of(scene)
    space.restrict_to_groups(('size',))
    space.select(space.table_of([]), [])
    labels = ['a', 'a', 'b', 'b', 'b', 'a']
    chosen = select_features(standardised(scene), labels, least=2)
    imagined = space.selected_by(lambda *data: select_features(*data, least=2), scene.features, labels)
    assert imagined.names_in_use == tuple(np.array(scene.feature_names)[chosen])
    np.testing.assert_allclose(imagined.points_of(scene.features), standardised(scene)[:, chosen], atol=1e-12)
    assert space.names_in_use == ('size_height',)


def test_distances_are_those_written_out(scene):
    """Root mean square, in standard deviations, over the features in use; none to no views."""
    space = space_of(scene)
    table = standardised(scene)
    expected = [[np.sqrt(np.mean((one - other) ** 2)) for other in table[:2]] for one in table]
    np.testing.assert_allclose(space.distances(scene.features, scene.features[:2]), expected, atol=1e-12)
    assert space.distances(scene.features, space.table_of([])).shape == (6, 0)


@pytest.mark.parametrize(('tolerance', 'is_same'), [(0.0, False), (0.04, False), (0.06, True)])
def test_a_view_is_the_same_within_the_tolerance(scene, tolerance, is_same):
    """In standard deviations, and by all features, those too that are not in use."""
    space = space_of(scene, view_tolerance=tolerance)
    space.restrict_to_groups(('size',))
    space.select(space.table_of([]), [])
    noisy = scene.features + 0.1 * scene.features.std(axis=0) * np.array([1, 0, 0, 0])
    assert space.are_same(scene.features, noisy).tolist() == [is_same] * 6
    assert space.are_same(scene.features, scene.features).all()


@pytest.mark.parametrize('tolerance', [-1, np.nan, np.inf, '0.1'])
def test_a_tolerance_that_is_none_is_refused(tolerance):
    """Otherwise every view would be new, or none."""
    with pytest.raises(InputError, match='view_tolerance'):
        FeatureSpace(view_tolerance=tolerance)


def test_views_that_do_not_fit_are_refused(scene):
    """Otherwise a fit would end with what numpy says of shapes."""
    space = space_of(scene)
    space.check_view(0, scene.features[0])
    for features, reason in (
        (scene.features[0, :2], r'features have shape \(2,\), expected \(4,\)'),
        (np.full(4, np.nan), 'the features of object 7 are not all finite'),
    ):
        with pytest.raises(InputError, match=reason):
            space.check_view(7, features)
