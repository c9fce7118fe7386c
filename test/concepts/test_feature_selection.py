"""Computational feature selection against scikit-learn's filter."""

import numpy as np
import pytest
from scipy.stats import kruskal
from sklearn.feature_selection import f_classif

from al_questioner.concepts.feature_selection import anova_p_values, rank_p_values, select_features
from al_questioner.domain import InputError


@pytest.mark.parametrize('seed', range(10))
def test_p_values_equal_scikit_learn(seed):
    """Classes of unequal size, single examples among them, and offsets far from zero."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(5, 40))
    features = rng.normal(size=(n, 6)) + rng.normal(scale=100, size=6)
    labels = [*rng.choice(['a', 'b', 'c'], p=[0.7, 0.2, 0.1], size=n - 3), 'a', 'a', 'b']
    np.testing.assert_allclose(anova_p_values(features, labels), f_classif(features, labels)[1], rtol=1e-6, atol=1e-12)


def test_informative_features_are_kept_and_most_others_dropped():
    rng = np.random.default_rng(0)
    labels = ['a', 'b'] * 30
    features = rng.normal(size=(60, 40))
    features[::2, :8] += 3
    selected = select_features(features, labels)
    assert selected[:8].all()
    assert selected[8:].mean() < 0.2


def test_few_labels_keep_the_best_features_however_weak():
    """With three labels hardly anything is significant; the learner must not be left without features."""
    rng = np.random.default_rng(1)
    features = rng.normal(size=(3, 30))
    features[:, 4] = [0.0, 0.001, 5.0]
    selected = select_features(features, ['a', 'a', 'b'], significance=1e-12, least=3)
    assert selected.sum() == 3
    assert selected[4]


@pytest.mark.parametrize('labels', [[], ['a'], ['a', 'a', 'a'], ['a', 'b', 'c']])
def test_all_features_without_a_test(labels):
    """One class, or no class with two examples, leaves no variance to compare."""
    assert select_features(np.random.default_rng(0).normal(size=(len(labels), 4)), labels).all()


@pytest.mark.parametrize('value', [0.0, 0.1, 1e6 + 0.1])
def test_constant_features_say_nothing(value):
    """Rounding in the mean of equal values must not look like a difference between classes."""
    features = np.column_stack([np.full(7, value), [0, 0, 0, 0, 1, 1, 1.0]])
    assert anova_p_values(features, list('aaaabbb')).tolist() == [1.0, 0.0]


def test_unit_of_a_feature_does_not_matter():
    rng = np.random.default_rng(2)
    features, labels = rng.normal(size=(12, 5)), list('aaabbbcccabc')
    scaled = features * rng.uniform(1, 1000, size=5) + rng.normal(size=5)
    np.testing.assert_allclose(anova_p_values(scaled, labels), anova_p_values(features, labels), rtol=1e-8)


def test_shapes_that_do_not_fit():
    with pytest.raises(InputError, match='do not fit 3 labels'):
        select_features(np.zeros((2, 4)), list('abc'))


@pytest.mark.parametrize('seed', range(5))
def test_rank_p_values_equal_scipy_feature_by_feature(seed):
    """Otherwise a selector that is varied would be another than the one named."""
    rng = np.random.default_rng(seed)
    features = rng.integers(0, 4, size=(15, 6)).astype(float)
    features[:, 2] = 7.0
    labels = ['a', 'b', 'c', *rng.choice(['a', 'b', 'c'], size=12)]
    found = rank_p_values(features, labels)
    for column in range(6):
        groups = [features[np.array(labels) == name, column] for name in ('a', 'b', 'c')]
        assert found[column] == pytest.approx(1.0 if column == 2 else kruskal(*groups).pvalue)
    selected = select_features(features, labels, significance=0.0, least=2, p_values=rank_p_values)
    assert set(np.flatnonzero(selected)) == set(np.argsort(found, kind='stable')[:2])
