"""What things are taken for: calibrated probabilities of every symbol and of none."""

from __future__ import annotations

import numpy as np

from al_questioner.concepts.concept_learner import ConceptLearner
from al_questioner.domain import FloatArray
from al_questioner.support.arrays import Array

LEAST_PROBABILITY = 1e-9
"""Smallest q_y that is told from 0, so that odds stay finite."""


def recognise(concepts: ConceptLearner, features: FloatArray) -> Array:
    """Return (k, |Y| + 1) probabilities of (k, m) raw features: of each symbol, and as the last that of none.

    Each row adds up to 1. Exactly one of them is true, so that p(y) is proportional to q_y / (1 - q_y), and p(none)
    to 1.
    """
    q = np.clip(concepts.predict_proba(features), LEAST_PROBABILITY, 1.0 - LEAST_PROBABILITY)
    odds = np.append(q / (1.0 - q), np.ones((len(q), 1)), axis=1)
    probabilities: Array = odds / odds.sum(axis=1, keepdims=True)
    return probabilities
