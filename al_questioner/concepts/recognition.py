"""Recognition: calibrated probabilities of every symbol, and of none, that a thing is taken for.

The derivation, and how the constants were chosen, is in docs/explanation/recognition.md.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from al_questioner.concepts.concept_learner import ConceptLearner
from al_questioner.domain import NO_SYMBOL, FloatArray
from al_questioner.support.arrays import Array

LEAST_DISTANCE, LARGEST_DISTANCE = 0.05, 3.0
"""Bounds of a distance: the one in the unit of `Evidence`, the other in standard deviations of a feature."""
LEAST_PROBABILITY = 1e-9
"""Smallest q_y that is told from 0, so that odds stay finite."""
LEAST_SPACING = 1e-3
"""Smallest spacing of things in standard deviations: where all look alike it would be 0."""
ROWS_AT_ONCE = 512
"""Rows of a table of distances that are in memory at a time."""


class Calibration(NamedTuple):
    """Constants of the probabilities.

    Attributes:
        sharpness: power to which the odds of q_y are taken; alone, they are too cautious.
        reach: how far a label tells what things are, in standard deviations of a feature, root mean square.
        doubt: votes, of which a label has one, for what no label tells.
        none_weight: odds of none at the distance 1 from all that matters, where all that is of none is far.
        steepness: power of the distances by which their nearness counts.
    """

    sharpness: float = 1.7
    reach: float = 0.25
    doubt: float = 0.03
    none_weight: float = 0.015
    steepness: float = 2.55


class Evidence(NamedTuple):
    """Evidence of what k things are.

    Attributes:
        log_odds: (k, |Y|) logarithms of q_y / (1 - q_y).
        examples: (k, |Y|) distances to the nearest example of each symbol, in standard deviations of a feature, root
            mean square; infinite without any.
        mattering: (k,) distances to the nearest view that is of some symbol. The unit is the geometric mean of a
            standard deviation and the spacing of the things seen.
        of_none: (k,) distances to the nearest view that is of none, likewise; infinite without any.
    """

    log_odds: Array
    examples: Array
    mattering: Array
    of_none: Array


DEFAULT_CALIBRATION = Calibration()


def weigh(evidence: Evidence, calibration: Calibration = DEFAULT_CALIBRATION) -> Array:
    """Return (k, |Y| + 1) probabilities of each symbol, and as the last that of none; each row adds up to 1.

    The odds of symbol y are those of q_y to the power of the sharpness a, times its votes,
    exp(-d_y^2 / (2 reach^2)) + doubt. The odds of none are w (d^b + (d / d_none)^b), with the distances d to what
    matters and d_none to what is of none.
    """
    votes = np.exp(-((evidence.examples / calibration.reach) ** 2) / 2) + calibration.doubt
    far = np.log(evidence.mattering + LEAST_DISTANCE)
    near = np.log(evidence.of_none + LEAST_DISTANCE)
    none = np.log(calibration.none_weight) + calibration.steepness * far
    none = none + np.logaddexp(0.0, -calibration.steepness * near)
    scores = np.column_stack([calibration.sharpness * evidence.log_odds + np.log(votes), none])
    odds = np.exp(scores - scores.max(axis=1, keepdims=True))
    probabilities: Array = odds / odds.sum(axis=1, keepdims=True)
    return probabilities


class Recogniser:
    """Recognises things by what a learner knows whenever it is asked.

    Args:
        concepts: the learner.
    """

    def __init__(self, concepts: ConceptLearner) -> None:
        self.concepts = concepts
        self._measured: tuple[int, float] | None = None

    def probabilities(self, features: FloatArray) -> Array:
        """Return (k, |Y| + 1) probabilities of (k, m) raw features: of each symbol, and as the last that of none."""
        return weigh(self.evidence(features))

    def evidence(self, features: FloatArray) -> Evidence:
        """Return the evidence of what things with (k, m) raw features are."""
        concepts = self.concepts
        q = np.clip(concepts.predict_proba(features), LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
        labelled, points, unit = concepts.labelled_views, concepts.points_of(features), np.sqrt(self._spacing())
        by_label = {
            name: self._distances(points, [view.features for view in labelled if view.label == name])
            for name in (*concepts.symbols, NO_SYMBOL)
        }
        of_none = by_label.pop(NO_SYMBOL)
        judged = self._distances(points, [view.features for view in concepts.judged_views if view.matters])
        examples = np.stack(list(by_label.values()), axis=1)
        mattering = np.minimum(examples.min(axis=1), judged)
        return Evidence(
            np.log(q) - np.log1p(-q), examples, np.minimum(mattering, LARGEST_DISTANCE) / unit, of_none / unit
        )

    def _distances(self, points: Array, views: list[FloatArray]) -> Array:
        """Return (k,) distances of points to the nearest view, in standard deviations, root mean square."""
        if not views:
            return np.full(len(points), np.inf)
        table = _distances(points, self.concepts.points_of(np.array(views)))
        return np.asarray(table.min(axis=1) / np.sqrt(points.shape[1]))

    def _spacing(self) -> float:
        """Return the median distance of a view that was seen to the nearest other one, likewise."""
        version = self.concepts.model_version
        if self._measured is None or self._measured[0] != version:
            self._measured = version, median_spacing(self.concepts.points_of(self.concepts.seen.features))
        return self._measured[1]


def recognise(concepts: ConceptLearner, features: FloatArray) -> Array:
    """Return the (k, |Y| + 1) probabilities of (k, m) raw features by a learner, see `Recogniser.probabilities`."""
    return Recogniser(concepts).probabilities(features)


def median_spacing(points: Array) -> float:
    """Return the median distance of (n, m) points to the nearest other one, root mean square; 1 for fewer than two."""
    if len(points) < 2:
        return 1.0
    nearest = np.empty(len(points))
    for begin in range(0, len(points), ROWS_AT_ONCE):
        rows = np.arange(begin, min(begin + ROWS_AT_ONCE, len(points)))
        table = _distances(points[rows], points)
        table[np.arange(len(rows)), rows] = np.inf
        nearest[rows] = table.min(axis=1)
    return max(float(np.median(nearest)) / float(np.sqrt(points.shape[1])), LEAST_SPACING)


def _distances(points: Array, others: Array) -> Array:
    """Return the (k, n) Euclidean distances of (k, m) points to (n, m) others."""
    # Only now, as scipy takes long to import, and most programs recognise nothing.
    from scipy.spatial.distance import cdist

    table: Array = cdist(points, others)
    return table
