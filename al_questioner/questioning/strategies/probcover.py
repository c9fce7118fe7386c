"""Strategy `probcover`: labels of the things in whose neighbourhood most of what was seen has no label near it yet.

It is ProbCover of Yehuda, Dekel, Hacohen and Weinshall, "Active Learning Through a Covering Lens" (2022), after one
early feature subset query, on the features in use in place of an embedding.
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

PURITY = 0.95
"""Share of the balls that must lie within one cluster, as in the paper."""


class ProbCover(UnlabelledFirst):
    """Strategy that labels the view whose ball covers most views that no labelled view covers."""

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) number of views that a label of each object would newly cover."""
        pool = view_pool(context)
        # As many as there are symbols, as in the paper; the same draws in every turn, see `TypiClust`.
        clusters = k_means(pool.points, len(context.symbols), random_stream(0, 'probcover'))
        covered = newly_covered(pool.points, pool.is_labelled, pool.in_view, pure_radius(pool.points, clusters))
        return covered.astype(np.float64)


def pure_radius(points: Array, clusters: NDArray[np.intp]) -> float:
    """Return the largest radius with which the balls around a share `PURITY` of (n, d) points are pure.

    A ball holds the points that are nearer than its radius; it is pure if all of them are of one cluster. The paper
    tries a grid of radii; this is the exact one. It is infinite for a single cluster.

    Args:
        points: all points.
        clusters: (n,) cluster of each.
    """
    nearest_other = np.full(len(points), np.inf)
    for cluster in np.unique(clusters):
        is_inside = clusters == cluster
        if not is_inside.all():
            nearest_other[is_inside] = cdist(points[is_inside], points[~is_inside]).min(axis=1)
    impure = int(np.floor(len(points) * (1 - PURITY) + 1e-9))
    return float(np.sort(nearest_other)[impure])


def newly_covered(
    points: Array, is_labelled: NDArray[np.bool_], rows: NDArray[np.intp], radius: float
) -> NDArray[np.intp]:
    """Return (k,) numbers of points within a ball around each of k rows that lie in no ball around a labelled point.

    Args:
        points: (n, d) all points.
        is_labelled: (n,) booleans.
        rows: (k,) rows of the points that could be labelled.
        radius: radius of the balls, without their surface.
    """
    is_open = ~(cdist(points[is_labelled], points) < radius).any(axis=0)
    return np.asarray((cdist(points[rows], points[is_open]) < radius).sum(axis=1))
