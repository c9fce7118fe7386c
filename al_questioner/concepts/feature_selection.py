"""Computational feature selection: search for the features that distinguish the labels, using only the labels."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import FloatArray, InputError
from al_questioner.support.arrays import Array
from al_questioner.support.late_imports import late

fdtrc = late('scipy.special', 'fdtrc')
kruskal = late('scipy.stats', 'kruskal')

Selector = Callable[[FloatArray, Sequence[str]], NDArray[np.bool_]]
"""Function that maps (n, m) features of labelled objects and their n labels to (m,) booleans: the features to use."""
PValues = Callable[[Array, Sequence[str]], Array]
"""Function that maps the same to (m,) p-values of a test that a feature is independent of the label."""


def anova_p_values(features: Array, labels: Sequence[str]) -> Array:
    """Return the (m,) p-values of the one-way analysis of variance of (n, m) features, 1 for a constant feature.

    That is the probability of an F statistic at least this large, if the feature had the same mean in all classes. Of
    the n labels k are different, 2 <= k < n.
    """
    classes, code = np.unique(np.asarray(labels), return_inverse=True)
    n, k = len(features), len(classes)
    membership = code[:, None] == np.arange(k)
    centred = features - features.mean(axis=0)
    means = (membership.T @ centred) / membership.sum(axis=0)[:, None]
    within = ((centred - means[code]) ** 2).sum(axis=0)
    between = (membership.sum(axis=0)[:, None] * means**2).sum(axis=0)
    # Rounding gives a constant feature a spread in the last digits, which F would take for a real difference.
    resolution = n * (np.finfo(np.float64).eps * np.abs(features).max(axis=0)) ** 2
    constant = between + within <= resolution
    with np.errstate(divide='ignore', invalid='ignore'):
        statistic = (between / (k - 1)) / (within / (n - k))
    return np.where(constant, 1.0, fdtrc(k - 1, n - k, np.where(constant, 0.0, statistic)))


def rank_p_values(features: Array, labels: Sequence[str]) -> Array:
    """Return the (m,) p-values of the Kruskal-Wallis test of (n, m) features, 1 for a constant feature.

    It uses ranks only. At least two of the n labels are different.
    """
    names = np.asarray(labels)
    constant = np.ptp(features, axis=0) == 0
    p_values = np.ones(features.shape[1])
    groups = [features[names == name][:, ~constant] for name in dict.fromkeys(labels)]
    p_values[~constant] = kruskal(*groups, axis=0).pvalue
    return p_values


def select_features(
    features: FloatArray,
    labels: Sequence[str],
    significance: float = 0.05,
    least: int = 5,
    p_values: PValues = anova_p_values,
) -> NDArray[np.bool_]:
    """Select the features that differ between the labels, by a one-way analysis of variance: a standard filter.

    With few labels the test has no power, so the `least` features of smallest p-value are always selected. `NO_SYMBOL`
    is a label like any other: to distinguish objects from clutter is part of the task.

    Args:
        features: (n, m) features of the labelled objects; their unit does not matter.
        labels: n names.
        significance: probability with which a feature without information is selected.
        least: number of features that are selected whatever their significance.
        p_values: the test.

    Returns:
        (m,) true for a feature to use; all of them if the labels allow no test (fewer than two different ones, or
        none that occurs twice).

    Raises:
        InputError: shapes that do not fit.
    """
    table = np.asarray(features, dtype=np.float64)
    if table.ndim != 2 or len(table) != len(labels):
        raise InputError(f'features of shape {table.shape} do not fit {len(labels)} labels')
    n_classes = len(set(labels))
    if not 2 <= n_classes < len(labels):
        return np.ones(table.shape[1], dtype=bool)
    found = p_values(table, labels)
    selected = found <= significance
    selected[np.argsort(found, kind='stable')[:least]] = True
    return selected


OTHER = 'other'
"""Name of a selector that is not of this package."""
_NAMED: dict[str, Selector | None] = {'': None, 'anova': select_features}


def name_of_selector(selector: Selector | None) -> str:
    """Return the name under which a selector is kept: empty for none, `OTHER` if it has no name."""
    return next((name for name, known in _NAMED.items() if known is selector), OTHER)


def selector_named(name: str) -> Selector | None:
    """Return the selector of a name; None for none, and for one that is not known here."""
    return _NAMED.get(name)
