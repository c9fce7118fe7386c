"""The published strategies for small budgets, held against scikit-activeml's implementations."""

from __future__ import annotations

import dataclasses
import json
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.distance import cdist
from sklearn.cluster import KMeans

from al_questioner.domain import NO_SYMBOL
from al_questioner.questioning import Episode, make_strategy
from al_questioner.questioning.strategies.probcover import newly_covered, pure_radius
from al_questioner.questioning.strategies.typiclust import typical_scores
from al_questioner.questioning.strategies.view_pool import k_means, view_pool
from shared.checkout import ROOT

ANSWERS: dict[str, Any] = json.loads(
    (ROOT / 'test/questioning/strategies/activeml_answers.json').read_text(encoding='utf-8')
)
"""Answers of scikit-activeml 1.0.1, by `python test/questioning/strategies/activeml_answers.py`."""
POINTS = np.array(ANSWERS['points'])


def among(rows: list[int]) -> NDArray[np.bool_]:
    """(n,) booleans that are true in these rows."""
    found = np.zeros(len(POINTS), dtype=bool)
    found[rows] = True
    return found


@pytest.mark.parametrize('state', ANSWERS['typiclust'], ids=lambda state: f'{len(state["labelled"])} labels')
def test_typiclust_asks_what_scikit_activeml_asks(state):
    """A control under a published name must be the published method."""
    is_labelled = among(state['labelled'])
    scores = typical_scores(POINTS, np.array(state['clusters']), is_labelled)
    scores[is_labelled] = -1
    best = scores.max()
    # Where parts are of one size it draws lots between them, and we take the more typical thing.
    assert max(scores[state['answers']]) == pytest.approx(best, abs=1e-9)
    assert np.floor(scores[state['answers']]).tolist() == [np.floor(best)] * len(state['answers'])


def test_most_answers_of_scikit_activeml_are_no_draw():
    """Otherwise the test above would hold for many wrong strategies."""
    alone = [state for state in ANSWERS['typiclust'] if len(state['answers']) == 1]
    assert len(alone) > len(ANSWERS['typiclust']) / 2


def test_probcover_has_the_radius_of_scikit_activeml():
    """Between its largest distance within a ball and ours, no two points lie."""
    theirs = ANSWERS['probcover']['largest_distance']
    ours = pure_radius(POINTS, np.array(ANSWERS['probcover']['clusters']))
    distances = cdist(POINTS, POINTS)
    assert theirs == pytest.approx(distances[distances < ours].max())


@pytest.mark.parametrize('state', ANSWERS['probcover']['states'], ids=lambda state: f'{len(state["labelled"])} labels')
def test_probcover_covers_what_scikit_activeml_covers(state):
    """All utilities are the same, so that all choices are."""
    radius = pure_radius(POINTS, np.array(ANSWERS['probcover']['clusters']))
    is_labelled = among(state['labelled'])
    rows = np.flatnonzero(~is_labelled)
    covered = newly_covered(POINTS, is_labelled, rows, radius)
    assert covered.tolist() == [state['covered'][row] for row in rows]


@pytest.mark.parametrize('count', [1, 2, 5, 12, 40])
def test_k_means_is_as_good_as_that_of_scikit_learn(count):
    """The clusters are what both strategies stand on."""
    reference = KMeans(count, n_init=4, random_state=0).fit(POINTS)
    clusters = k_means(POINTS, count, np.random.default_rng(0))
    centres = {cluster: POINTS[clusters == cluster].mean(axis=0) for cluster in np.unique(clusters)}
    error = sum(float(((POINTS[clusters == cluster] - centre) ** 2).sum()) for cluster, centre in centres.items())
    assert len(centres) == count
    assert error <= 1.05 * reference.inertia_
    assert np.array_equal(clusters, k_means(POINTS, count, np.random.default_rng(0)))


def test_k_means_of_fewer_points_than_clusters():
    """In the first turns of an episode there may be more labels than different views."""
    points = np.array([[0.0], [1.0], [1.0], [0.0], [5.0]])
    clusters = k_means(points, 4, np.random.default_rng(0))
    assert clusters[0] == clusters[3]
    assert clusters[1] == clusters[2]
    assert len(set(clusters.tolist())) == 3


def test_a_typical_thing_of_the_largest_part_without_labels_comes_first():
    """A part of three and one of two, both without labels, then one with a label."""
    points = np.array([0.0, 1.0, 2.1, 10.0, 10.1, 20.0, 20.1, 20.2, 20.3])[:, None]
    clusters = np.array([0, 0, 0, 1, 1, 2, 2, 2, 2])
    is_labelled = np.arange(9) == 5
    scores = typical_scores(points, clusters, is_labelled)
    assert scores[~is_labelled].argsort()[::-1].tolist()[:3] == [1, 0, 2]
    assert scores[3] == scores[4] > scores[[6, 7, 8]].max()
    assert scores[7] > scores[[6, 8]].max()


def test_the_radius_is_the_largest_with_which_nearly_all_balls_are_pure():
    """Twenty points with gaps of 1, and the other cluster at a distance of 3; one ball may be impure."""
    points = np.array([*range(19), 21.0])[:, None]
    clusters = np.array([0] * 19 + [1])
    assert pure_radius(points, clusters) == 3.0
    assert pure_radius(np.array([[0.0], [1.0], [3.0]]), np.array([0, 0, 1])) == 2.0
    assert pure_radius(points, np.zeros(20, dtype=int)) == np.inf


def pool_of(toy, *tables):
    """Context of the last of some scenes, all of other things, and the scenes."""
    scenes = [toy.scene(table, range(10 * i, 10 * i + len(table))) for i, table in enumerate(tables)]
    context = toy.context((), scenes[0])
    for scene in scenes[1:]:
        context.concepts.observe(scene)
    return dataclasses.replace(context, scene=scenes[-1]), scenes


def table_of(*values):
    """Features of which the third alone varies."""
    table = np.zeros((len(values), 5))
    table[:, 2] = values
    return table


@pytest.mark.parametrize('name', ['typiclust', 'probcover'])
def test_what_was_seen_before_counts(toy, name):
    """A crowd like the first of two things has left the view; without it there would be nothing to tell them apart."""
    crowd = table_of(0.0, 0.1, 0.2, 0.3, 0.4, 0.5)
    context, _ = pool_of(toy, crowd, table_of(0.25, 9.0))
    utilities = make_strategy(name, {}).score(context)
    assert utilities[0] > utilities[1]
    alone, _ = pool_of(toy, table_of(0.25, 9.0))
    assert len(set(make_strategy(name, {}).score(alone).tolist())) == 1


@pytest.mark.parametrize('name', ['typiclust', 'probcover'])
def test_labels_of_earlier_scenes_count(toy, name):
    """The crowd that has left had a label, so the other thing comes first."""
    context, scenes = pool_of(toy, table_of(0.0, 0.1, 0.2, 0.3, 0.4, 0.5), table_of(0.25, 9.0))
    context.concepts.label(2, scenes[0].features[2], NO_SYMBOL, 1)
    utilities = make_strategy(name, {}).score(dataclasses.replace(context))
    assert utilities[1] > utilities[0]


@pytest.mark.parametrize('name', ['typiclust', 'probcover'])
def test_only_the_features_in_use_count(toy, name):
    """A feature that the teacher called irrelevant must neither part nor join things."""
    table = table_of(0.0, 0.1, 0.2, 8.0, 9.0)
    table[:, 3] = [0, 50, -50, 100, -100]
    context, _ = pool_of(toy, table)
    context.concepts.restrict_to_groups(['size'])
    plain, _ = pool_of(toy, table_of(0.0, 0.1, 0.2, 8.0, 9.0))
    plain.concepts.restrict_to_groups(['size'])
    scores = [make_strategy(name, {}).score(dataclasses.replace(each)) for each in (context, plain)]
    np.testing.assert_allclose(*scores)


def test_the_pool_holds_each_view_once(toy):
    """A thing that stays, or comes back as it was, is no crowd; one that looks different is another view."""
    first, changed = toy.scene(table_of(0.0, 1.0)), toy.scene(table_of(0.0, 3.0))
    context = toy.context((), first)
    for scene in (first, changed, first):
        context.concepts.observe(scene)
    context.concepts.label(1, first.features[1], 'snack', 1)
    pool = view_pool(dataclasses.replace(context, scene=first))
    assert context.concepts.seen.object_ids == (0, 1, 1)
    assert pool.in_view.tolist() == [0, 1]
    assert pool.is_labelled.tolist() == [False, True, False]


@pytest.mark.parametrize('name', ['typiclust', 'probcover'])
def test_a_corrected_look_leaves_the_pool(toy, name):
    """A wrong first look is learnt again as it was; the pool must not keep what nobody saw."""
    episode = Episode(toy.settings(name, turns=20), np.random.default_rng(0))
    table = np.random.default_rng(1).normal(size=(6, 5))
    wrong = table.copy()
    wrong[0] = 1e6
    for looks in (wrong, table, table, table):
        decision = episode.ask(toy.scene(looks))
        if decision.query:
            episode.tell(toy.reply(decision.query, ('size',) if decision.turn == 1 else 'snack'))
    features = episode.concepts.seen.features
    assert len(features) == 6
    assert np.abs(features).max() < 10
