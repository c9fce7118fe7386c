"""The space in which views are compared: standardised features, and of these the ones in use."""

from __future__ import annotations

import copy
import itertools
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.feature_selection import Selector
from al_questioner.concepts.standardiser import Standardiser
from al_questioner.domain import FloatArray, InputError, Scene, SceneError, group_of, groups_of
from al_questioner.support.arrays import Array

VIEW_TOLERANCE = 1e-3
"""Largest root mean square change, in standard deviations, of a view that counts as the same: rounding only.

Noise is removed earlier, by a `ViewMemory`.
"""


class FeatureSpace:
    """Space of the features in use, in standard deviations of the observed views.

    In use are all features, or those that the teacher called relevant; of these, if there is a selector, those that it
    selects from the labels. The first scene decides which features there are.

    Args:
        selector: selects features computationally; None for all that the teacher has not ruled out.
        view_tolerance: largest change of an object's features in the same view, as of `VIEW_TOLERANCE`.

    Attributes:
        names: of all features, in the order of their columns; none before the first scene.
        groups: of all features, in the order in which they occur.
        standardiser: statistics of the observed views.

    Raises:
        InputError: a tolerance that is not a number of 0 or more.
    """

    def __init__(self, selector: Selector | None = None, view_tolerance: float = VIEW_TOLERANCE) -> None:
        if not (isinstance(view_tolerance, (int, float)) and np.isfinite(view_tolerance) and view_tolerance >= 0):
            raise InputError(f"view_tolerance must be 'auto' or a number of 0 or more, not {view_tolerance!r}")
        self.names: tuple[str, ...] = ()
        self.groups: tuple[str, ...] = ()
        self.standardiser = Standardiser(0)
        self._selector = selector
        self._view_tolerance = view_tolerance
        self._told_relevant: NDArray[np.bool_] | None = None
        self._in_use: NDArray[np.bool_] = np.ones(0, dtype=bool)

    @property
    def subset_was_told(self) -> bool:
        """True if the teacher has said which features are relevant."""
        return self._told_relevant is not None

    @property
    def names_in_use(self) -> tuple[str, ...]:
        """Names of the features in use."""
        return tuple(itertools.compress(self.names, self._in_use))

    @property
    def groups_in_use(self) -> list[str]:
        """Group of each feature in use."""
        return [group_of(name) for name in self.names_in_use]

    def check(self, scene: Scene) -> None:
        """Make sure that a scene has the features of the earlier scenes.

        Raises:
            SceneError: it has others.
        """
        if self.names and scene.feature_names != self.names:
            raise SceneError(_layout_difference(self.names, scene.feature_names))

    def admit(self, scene: Scene) -> None:
        """Make sure of that too, and let the first scene decide which features there are.

        Raises:
            SceneError: it has others.
        """
        self.check(scene)
        if not self.names:
            self.names, self.groups = scene.feature_names, groups_of(scene.feature_names)
            self.standardiser = Standardiser(len(self.names))
            self._in_use = np.ones(len(self.names), dtype=bool)

    def are_implausible(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n, m) booleans: the implausible readings of a scene, judged by the earlier views."""
        if not self.names:
            return np.zeros(scene.features.shape, dtype=bool)
        return self.standardiser.plausible_range.are_implausible(scene.features)

    def implausible_readings(self, scene: Scene) -> list[tuple[int, str, float]]:
        """Return object id, feature name and value of each implausible reading of a scene."""
        ids, names = scene.object_ids, scene.feature_names
        found = np.argwhere(self.are_implausible(scene))
        return [(ids[row], names[column], float(scene.features[row, column])) for row, column in found]

    def check_view(self, object_id: int, features: NDArray[np.float32]) -> None:
        """Make sure that the raw features of a view of an object fit those observed.

        Raises:
            InputError: not m features, or one that is not finite.
        """
        if features.shape != (len(self.names),):
            raise InputError(f'features have shape {features.shape}, expected {(len(self.names),)}')
        if not np.isfinite(features).all():
            raise InputError(f'the features of object {object_id} are not all finite')

    def restrict_to_groups(self, groups: Iterable[str]) -> None:
        """Let the next `select` use the features of these groups only.

        Raises:
            InputError: no group, or an unknown one.
        """
        chosen = tuple(groups)
        if not chosen:
            raise InputError('no feature group was named')
        for group in chosen:
            if group not in self.groups:
                raise InputError(f'unknown feature group {group!r}; known: {", ".join(self.groups)}')
        self._told_relevant = np.array([group_of(name) in chosen for name in self.names])

    def select(self, labelled: FloatArray, labels: Sequence[str]) -> None:
        """Decide again which features are in use, by what was told and by (n, m) raw features and their n labels."""
        told = self._told_relevant
        self._in_use = np.ones(len(self.names), dtype=bool) if told is None else told.copy()
        if self._selector is not None:
            self._in_use[self._in_use] = self._selector(self.points_of(labelled), labels)

    def selected_by(self, selector: Selector, labelled: FloatArray, labels: Sequence[str]) -> FeatureSpace:
        """Return the space in which just those are in use that a selector selects of all features.

        It selects by (n, m) raw features and their n labels. The statistics are shared.
        """
        space = copy.copy(self)
        space._in_use = selector(self.standardiser.transform(labelled), labels)
        return space

    def points_of(self, features: FloatArray) -> Array:
        """Return (k, number in use) features in use, in standard deviations, of (k, m) raw features."""
        return self.standardiser.transform(features)[:, self._in_use]

    def table_of(self, rows: Sequence[NDArray[np.float32]]) -> Array:
        """Return (k, m) raw features of k views, of which there may be none."""
        return np.array(rows, dtype=np.float64).reshape(len(rows), len(self.names))

    def distances(self, first: FloatArray, second: FloatArray) -> Array:
        """Return (n, k) distances of (n, m) raw features to (k, m) others, in the features in use.

        In standard deviations, as root mean square over the features.
        """
        points, others = self.points_of(first), self.points_of(second)
        squared: Array = np.mean((points[:, None] - others[None]) ** 2, axis=2)
        return np.sqrt(squared)

    def are_same(self, first: FloatArray, second: FloatArray) -> NDArray[np.bool_]:
        """Return (k,) booleans: whether each of (k, m) raw features shows the same view as its counterpart.

        All features count here, those that are not in use as well.
        """
        difference = (first.astype(np.float64) - second) / self.standardiser.scale
        same: NDArray[np.bool_] = np.sqrt(np.mean(difference**2, axis=1)) <= self._view_tolerance
        return same


def _layout_difference(expected: tuple[str, ...], actual: tuple[str, ...]) -> str:
    if len(expected) != len(actual):
        return f'the scene has {len(actual)} features, those before had {len(expected)}'
    position = next(i for i, (e, a) in enumerate(zip(expected, actual, strict=True)) if e != a)
    return f'feature {position} of the scene is {actual[position]!r}, it was {expected[position]!r} before'
