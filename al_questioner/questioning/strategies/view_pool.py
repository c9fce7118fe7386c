"""The views of all scenes so far as a pool of points, and its clusters, for strategies of pool-based active learning.

They weigh what could be asked now by all that was seen, so their methods are those of their papers, but that only
objects in view can be asked about.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning.turn_context import TurnContext
from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

cdist = late('scipy.spatial.distance', 'cdist')

STARTS = 4
"""Number of starts of k-means, of which the best result counts."""
ITERATIONS = 100
"""Largest number of steps from one start; nearly always the clusters stay the same much earlier."""


@dataclass(frozen=True, eq=False)
class ViewPool:
    """Distinct views seen so far.

    Attributes:
        points: (n, d) features in use, in standard deviations.
        is_labelled: (n,) booleans.
        in_view: (|X|,) row of the view of each object of the present scene.
    """

    points: Array
    is_labelled: NDArray[np.bool_]
    in_view: NDArray[np.intp]


def view_pool(context: TurnContext) -> ViewPool:
    """Return the pool of a turn; its scene is the one that was observed last."""
    concepts = context.concepts
    seen = concepts.seen
    return ViewPool(
        concepts.points_of(seen.features), concepts.is_labelled(seen), seen.latest_rows(context.scene.object_ids)
    )


def k_means(points: Array, count: int, rng: np.random.Generator) -> NDArray[np.intp]:
    """Return (n,) the cluster of each of (n, d) points, of `count` clusters: the best of some starts of k-means.

    The starts are drawn by k-means++ (Arthur and Vassilvitskii 2007). There are fewer clusters if fewer points differ.
    """
    # Shifted to their mean, so that products of points do not drown their differences.
    centred = points - points.mean(axis=0)
    best, least = np.zeros(len(points), dtype=np.intp), np.inf
    for _ in range(STARTS):
        clusters, error = _settle(centred, _first_centres(centred, count, rng))
        if error < least:
            best, least = clusters, error
    return best


def _first_centres(points: Array, count: int, rng: np.random.Generator) -> Array:
    """Draw up to `count` distinct points, each with a chance that grows with the square of its distance to the rest.

    Of some draws for each, the one that leaves the least distances is taken, as in scikit-learn.
    """
    trials = 2 + int(np.log(count))
    chosen = [int(rng.integers(len(points)))]
    nearest = cdist(points, points[chosen], 'sqeuclidean')[:, 0]
    while len(chosen) < count and nearest.any():
        drawn = rng.choice(len(points), trials, p=nearest / nearest.sum())
        left = np.minimum(nearest, cdist(points[drawn], points, 'sqeuclidean'))
        best = int(np.argmin(left.sum(axis=1)))
        chosen.append(int(drawn[best]))
        nearest = left[best]
    return points[chosen]


def _settle(points: Array, centres: Array) -> tuple[NDArray[np.intp], float]:
    """Return (n,) clusters and their sum of squared distances after Lloyd's algorithm from (k, d) centres."""
    clusters = np.full(len(points), -1, dtype=np.intp)
    for _ in range(ITERATIONS):
        # |x - c|^2 without |x|^2, which is the same for all centres.
        found = np.argmin((centres**2).sum(axis=1) - 2 * points @ centres.T, axis=1)
        if np.array_equal(found, clusters):
            break
        clusters = found
        belongs = (clusters[:, None] == np.arange(len(centres))).astype(np.float64)
        sizes = belongs.sum(axis=0)
        filled = sizes > 0
        centres = centres.copy()
        centres[filled] = (belongs.T @ points)[filled] / sizes[filled, None]
    return clusters, float(((points - centres[clusters]) ** 2).sum())
