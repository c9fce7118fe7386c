"""Strategy `typiclust`: labels of typical things, each from a part of what was seen that has no label yet.

It is TPC_RP of Hacohen, Dekel and Weinshall, "Active Learning on a Budget: Opposite Strategies Suit High and Low
Budgets" (2022), after one early feature subset query, on the features in use in place of an embedding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import random_stream
from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.strategies.view_pool import k_means, view_pool
from al_questioner.questioning.turn_context import TurnContext
from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

cdist = late('scipy.spatial.distance', 'cdist')

NEIGHBOURS = 20
"""Number of nearest neighbours whose mean distance tells how typical a view is, as in the paper."""
MOST_CLUSTERS = 500
"""Largest number of clusters, as in the paper."""


class TypiClust(UnlabelledFirst):
    """Strategy that labels the most typical view in view of the largest cluster that has the fewest labels."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) scores of the objects: the rank of its cluster, and how typical each is of it."""
        pool = view_pool(context)
        count = min(int(pool.is_labelled.sum()) + 1, MOST_CLUSTERS)
        # The same draws in every turn, so that the clusters change only with what is seen and labelled.
        clusters = k_means(pool.points, count, random_stream(0, 'typiclust'))
        return typical_scores(pool.points, clusters, pool.is_labelled)[pool.in_view]


def typical_scores(points: Array, clusters: NDArray[np.intp], is_labelled: NDArray[np.bool_]) -> Array:
    """Return (n,) scores of (n, d) points: first by their cluster, then by how typical of it they are.

    Clusters with fewer labels come first, among them the larger ones: there is one more cluster than labels, so that
    one at least has none. Where no point of the first cluster can be asked about, the next one counts.

    Args:
        points: all points.
        clusters: (n,) cluster of each.
        is_labelled: (n,) booleans.
    """
    sizes = np.bincount(clusters)
    labels = np.bincount(clusters[is_labelled], minlength=len(sizes))
    merits = -labels * (len(points) + 1) + sizes
    scores = np.searchsorted(np.unique(merits), merits)[clusters].astype(np.float64)
    for cluster in np.flatnonzero(sizes):
        members = np.flatnonzero((clusters == cluster) & ~is_labelled)
        scores[members] += _typicalities(points[members])
    return scores


def _typicalities(points: Array) -> Array:
    """Return (n,) how typical each of the (n, d) points of a cluster is, from 0 to 1; 0 for one that is alone.

    The paper takes 1 / d, with d the mean distance to the nearest neighbours; this is 1 / (1 + d), of the same order.
    """
    others = min(NEIGHBOURS, len(points) - 1)
    if others < 1:
        return np.zeros(len(points))
    nearest = np.sort(cdist(points, points), axis=1)[:, 1 : others + 1]
    return np.asarray(1 / (1 + nearest.mean(axis=1)))
