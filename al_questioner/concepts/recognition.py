"""Recognition: calibrated probabilities of every symbol, and of none, that a thing is taken for."""

The derivation, and how the constants were chosen, is in docs/explanation/recognition.md.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial.distance import cdist

from al_questioner.concepts.concept_learner import ConceptLearner
from al_questioner.domain import NO_SYMBOL, FloatArray
from al_questioner.support.arrays import Array

SHARPNESS = 2.3
"""Power to which the odds of q_y are taken: alone, they are too cautious."""
NONE_WEIGHT = 0.15
"""Weight of none where a thing is as far from all that matters as the things seen are from each other."""
STEEPNESS = 2.6
"""Power of the distances by which their nearness counts."""
LEAST_DISTANCE, LARGEST_DISTANCE = 0.05, 3.0
"""Bounds of a distance: the one in spacings of the things seen, the other in standard deviations of a feature."""
LEAST_PROBABILITY = 1e-9
"""Smallest q_y that is told from 0, so that odds stay finite."""
LEAST_SPACING = 1e-3
"""Smallest spacing of things in standard deviations: where all look alike it would be 0."""
ROWS_AT_ONCE = 512
"""Rows of a table of distances that are in memory at a time."""


class Recogniser:
    """Recognises things by what a learner knows whenever it is asked.

    Args:
        concepts: the learner.
    """

    def __init__(self, concepts: ConceptLearner) -> None:
        self.concepts = concepts
        self._measured: tuple[int, float] | None = None

    def probabilities(self, features: FloatArray) -> Array:
        """Return (k, |Y| + 1) probabilities of (k, m) raw features: of each symbol, and as the last that of none.

        Each row adds up to 1. The odds of symbol y are those of q_y to the power of `SHARPNESS`. The odds of none grow
        with the distance to the nearest view that matters, and with the nearness of a view of none.
        """
        concepts = self.concepts
        q = np.clip(concepts.predict_proba(features), LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
        scores = np.column_stack([SHARPNESS * (np.log(q) - np.log1p(-q)), self._none_scores(features)])
        odds = np.exp(scores - scores.max(axis=1, keepdims=True))
        probabilities: Array = odds / odds.sum(axis=1, keepdims=True)
        return probabilities

    def _none_scores(self, features: FloatArray) -> Array:
        """Return (k,) logarithms of the odds of none."""
        concepts = self.concepts
        labelled, points = concepts.labelled_views, concepts.points_of(features)
        mattering = [view.features for view in labelled if view.label != NO_SYMBOL]
        mattering += [view.features for view in concepts.judged_views if view.matters]
        of_none = [view.features for view in labelled if view.label == NO_SYMBOL]
        spacing = self._spacing()
        far = np.log(self._distances(points, mattering) / spacing + LEAST_DISTANCE)
        scores: Array = np.log(NONE_WEIGHT) + STEEPNESS * far
        if of_none:
            near = np.log(self._distances(points, of_none) / spacing + LEAST_DISTANCE)
            scores = scores + np.logaddexp(0.0, -STEEPNESS * near)
        return scores

    def _distances(self, points: Array, views: list[FloatArray]) -> Array:
        """Return (k,) distances of points to the nearest view, in standard deviations, root mean square."""
        if not views or not points.shape[1]:
            return np.full(len(points), LARGEST_DISTANCE)
        others = self.concepts.points_of(np.array(views))
        nearest: Array = cdist(points, others).min(axis=1) / np.sqrt(points.shape[1])
        return np.minimum(nearest, LARGEST_DISTANCE)

    def _spacing(self) -> float:
        """Return the median distance of a view that was seen to the nearest other one, likewise."""
        version = self.concepts.model_version
        if self._measured is None or self._measured[0] != version:
            self._measured = version, _median_spacing(self.concepts.points_of(self.concepts.seen.features))
        return self._measured[1]


def recognise(concepts: ConceptLearner, features: FloatArray) -> Array:
    """Return the (k, |Y| + 1) probabilities of (k, m) raw features by a learner, see `Recogniser.probabilities`."""
    return Recogniser(concepts).probabilities(features)


def _median_spacing(points: Array) -> float:
    if len(points) < 2 or not points.shape[1]:
        return 1.0
    nearest = np.empty(len(points))
    for begin in range(0, len(points), ROWS_AT_ONCE):
        rows = np.arange(begin, min(begin + ROWS_AT_ONCE, len(points)))
        table = cdist(points[rows], points)
        table[np.arange(len(rows)), rows] = np.inf
        nearest[rows] = table.min(axis=1)
    return max(float(np.median(nearest)) / float(np.sqrt(points.shape[1])), LEAST_SPACING)
