"""Balance of the classes: what the counts of examples, an accident of what was asked, do to the degrees, taken back.

The counts act like a prior, of which the labels that were asked for say nothing. Derived in docs/explanation/method.md.
"""

from __future__ import annotations

import numpy as np

from al_questioner.support.arrays import Array


def count_odds(counts: Array, class_balance: float) -> Array:
    """Return (..., |Y|) factors by which counts of examples, (..., |Y|), are taken to have raised the odds of q_y.

    That is n_y + 1/2, over its geometric mean over y, to the power of the class balance.
    """
    logs = np.log(counts + 0.5)
    odds: Array = np.exp(class_balance * (logs - logs.mean(axis=-1, keepdims=True)))
    return odds


def balance_degrees(degrees: Array, counts: Array, class_balance: float) -> Array:
    """Return degrees (..., |Y|) as they would be if all symbols had as many examples, as far as the balance says."""
    if class_balance == 0:
        return degrees
    balanced: Array = degrees / (degrees + (1 - degrees) * count_odds(counts, class_balance))
    return balanced


def largest_slope(counts: Array, class_balance: float) -> float:
    """Return a bound on how much balancing enlarges the error of a degree, over (..., |Y|) counts."""
    odds = count_odds(counts, class_balance)
    return float(max(odds.max(), 1 / odds.min()))
