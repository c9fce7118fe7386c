"""Features of each object without the noise of the sensors; they change only when the view really changes."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.view_noise import ViewNoise
from al_questioner.domain import FloatArray, Scene
from al_questioner.support.arrays import Array

MANY_FEATURES_MOVED, FAR_IN_ALL = 0.15, 0.5
"""Limits of noise, in spreads: the movement of half of the features, and the root mean square of all."""
LARGEST_STEP = 3.0
"""Largest movement of a feature that counts, in spreads; so one wrong reading is no change of the whole object."""
AGREEMENT = 0.25
"""Largest squared distance of two looks that agree, as a share of that from the nearest known view."""
CERTAIN = 12.0
"""Movement of half of the features, in standard deviations of the noise, with which one look proves a change."""
BEYOND_ALL = 20.0
"""Movement of half of the features, in spreads, beyond which a look is like no other object and may be wrong."""
OWN_LOOKS = 4
"""Number of latest looks at an object that show whether it is noisier than usual."""
SMALLEST_CHANGE = 0.1
"""Smallest change of a view, in spreads, root mean square over the features; less is ignored even without noise."""
FIRST_LOOK_ERROR = 0.5
"""Largest error of the only look at a view, in spreads, root mean square, as later looks show it."""
LEAST_THINGS = 3
"""Number of objects from which the spread of a feature among objects is known well enough to compare with it."""
LOOKS_TO_FOLLOW = 8
"""Number of pairs of looks from which the noise is known well enough to follow a slow drift."""
VIEWS_KEPT = 64
"""Number of views of an object that are recognised when they return."""


@dataclass
class _KnownView:
    """A view as it is kept, (m,) raw features, and the last look at it, which differs by noise and drift."""

    kept: NDArray[np.float32]
    look: NDArray[np.float32]
    was_seen_again: bool = False


class Correction(NamedTuple):
    """A correction of what earlier scenes show of a thing: (m,) features that it had there, and that it has.

    Attributes:
        is_of_last_look: whether only the last scene that shows the thing is wrong: it was taken for the view before,
            and was the first look at another one. Otherwise the only look at a view was wrong, in whichever scene.
    """

    object_id: int
    wrong: NDArray[np.float32]
    right: NDArray[np.float32]
    is_of_last_look: bool = False


class _Track:
    """The views of one object."""

    def __init__(self, features: NDArray[np.float32]) -> None:
        self.views = [_KnownView(features, features)]
        self.current = self.views[0]
        self.last_look = self.look_before = features
        self.doubtful: NDArray[np.float32] | None = None
        self._sizes: deque[float] = deque(maxlen=OWN_LOOKS)

    @property
    def own_noise(self) -> float:
        """Mean square of the differences between two looks at this object, relative to the usual one; 1 or more.

        It is the lower median of the latest ones, of two at least, so that one change does not raise it.
        """
        ordered = sorted(self._sizes)
        return max(1.0, ordered[(len(ordered) - 1) // 2]) if len(ordered) > 1 else 1.0

    def add_size(self, size: float) -> None:
        """Add the mean square of the difference of a look from the last one, in deviations of the usual noise."""
        self._sizes.append(size)

    def begin_view(self, features: NDArray[np.float32]) -> None:
        self.current = _KnownView(features, features)
        self.views = [*self.views[1 - VIEWS_KEPT :], self.current]
        self.doubtful = None


class ViewMemory:
    """Memory that gives every object exactly its first features of a view, until it really looks different.

    A look shows a known view if it differs from the last look at it by no more than noise (see `ViewNoise`). It is
    another view at once if most of its features have moved far beyond noise. A smaller change counts when the next
    look confirms it: a burst of noise or a wrong reading does not repeat exactly.
    If readings repeat exactly, as in the simulated world, scenes are returned unchanged.

    Attributes:
        corrections: what the latest scene showed to be wrong in those before. A view with a single look can be: if
            later looks agree on something near, or if it was like no other object. So can the last scene be, if it
            showed already what the latest scene shows to be another view.
    """

    def __init__(self) -> None:
        self.corrections: list[Correction] = []
        self._tracks: dict[int, _Track] = {}
        self._names: tuple[str, ...] = ()
        self._noise = ViewNoise(0)
        self._spread: Array = np.zeros(0)
        self._spread_is_known = False

    @property
    def noise(self) -> dict[str, float]:
        """Standard deviation of each feature's noise by its name, in spreads of the feature; empty before two looks."""
        if self._noise.count == 0:
            return {}
        return dict(zip(self._names, (self._noise.deviations / self._spread).tolist(), strict=True))

    def steady(self, scene: Scene, spread: Array, is_wrong: NDArray[np.bool_] | None = None) -> Scene:
        """Return the scene without noise: a known view has exactly the features of its first look.

        Args:
            scene: the present scene, with the features of the earlier ones.
            spread: (m,) spread of each feature among objects.
            is_wrong: (n, m) wrong readings; the object keeps its earlier reading instead.
        """
        if not self._names:
            self._names, self._noise = scene.feature_names, ViewNoise(len(scene.feature_names))
        self._spread, self._spread_is_known = spread, len(self._tracks) >= LEAST_THINGS
        looks = np.array(scene.features, dtype=np.float32)
        known = [row for row, object_id in enumerate(scene.object_ids) if object_id in self._tracks]
        tracks = [self._tracks[scene.object_ids[row]] for row in known]
        if is_wrong is not None and is_wrong.any():
            for row, track in zip(known, tracks, strict=True):
                looks[row] = np.where(is_wrong[row], track.last_look, looks[row])
        if tracks:
            self._learn_noise(looks[known], tracks)
        kept, self.corrections = looks.copy(), []
        for row in known:
            kept[row] = self._settle(scene.object_ids[row], looks[row])
        new = [row for row, object_id in enumerate(scene.object_ids) if object_id not in self._tracks]
        self._tracks.update({scene.object_ids[row]: _Track(looks[row]) for row in new})
        return scene if np.array_equal(kept, scene.features) else dataclasses.replace(scene, features=kept)

    def _learn_noise(self, looks: NDArray[np.float32], tracks: Sequence[_Track]) -> None:
        """Learn the noise from the objects that seem still: from their difference to the last look."""
        differences = _differences(looks, [track.last_look for track in tracks])
        self._noise.learn(differences[~self._have_moved(differences)], self._spread)
        sizes = np.mean(self._noise.scale(differences) ** 2, axis=1)
        for track, look, size in zip(tracks, looks, sizes.tolist(), strict=True):
            track.look_before, track.last_look = track.last_look, look
            track.add_size(size)

    def _settle(self, object_id: int, look: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the features of a known object, given a look at it."""
        track = self._tracks[object_id]
        if np.array_equal(look, track.current.look):
            track.current.was_seen_again, track.doubtful = True, None
            return track.current.kept
        view, difference = self._nearest_view(track, look)
        excess, size = float(self._noise.excess(difference)[0]), float(self._size(difference)[0])
        is_confirmed = self._is_confirmed(track, look, excess)
        if excess <= track.own_noise or size <= SMALLEST_CHANGE:
            track.current, track.doubtful = view, None
            view.was_seen_again |= excess <= 1
            # A look that only this object's own noise explains may be a change, so the view does not follow it.
            if excess <= 1 and self._noise.count >= LOOKS_TO_FOLLOW:
                view.look = look
        elif not (is_confirmed or self._is_certain(difference)):
            track.doubtful = look
        elif not view.was_seen_again and self._was_wrong(object_id, view, look, size, is_confirmed):
            self.corrections.append(Correction(object_id, view.kept, look))
            track.current, track.doubtful = view, None
            view.kept = view.look = look
        else:
            if self._agrees(track, look, track.look_before, excess):
                # What was said of the thing when it looked so for the first time is said of this view.
                self.corrections.append(Correction(object_id, track.current.kept, look, is_of_last_look=True))
            track.begin_view(look)
        return track.current.kept

    def _was_wrong(
        self, object_id: int, view: _KnownView, look: NDArray[np.float32], size: float, is_confirmed: bool
    ) -> bool:
        """Return whether the only look at a view was wrong, given another look that differs from it by this size.

        It was wrong if the two are near and the look before agreed with the new one. It was also wrong if it is far
        from the new look and from all other objects: in one feature if the look before agreed, otherwise in half of
        them.
        """
        if is_confirmed and size <= FIRST_LOOK_ERROR:
            return True
        others = [track.current.kept for other, track in self._tracks.items() if other != object_id]
        table = np.array([look, *others], dtype=np.float64)
        low, high = table.min(axis=0), table.max(axis=0)
        sizes = np.where(look == 0, 1.0, np.abs(look))
        extent = np.where(high > low, high - low, sizes)
        beyond = np.maximum(view.kept - high, low - view.kept) / extent
        return bool((beyond.max() if is_confirmed else _lower_median(beyond[None])[0]) > BEYOND_ALL)

    def _nearest_view(self, track: _Track, look: NDArray[np.float32]) -> tuple[_KnownView, Array]:
        """Return the known view that is nearest to a look, and the (1, m) difference from it.

        The difference is from the first or the last look at it: the last one follows a drift, but it may have been a
        burst.
        """
        looks = [view.look for view in track.views] + [view.kept for view in track.views]
        differences = _differences(look, looks)
        nearest = int(np.argmin(self._noise.excess(differences)))
        return track.views[nearest % len(track.views)], differences[[nearest]]

    def _is_certain(self, difference: Array) -> bool:
        """Return whether one look, with its (1, m) difference from the nearest view, is enough to prove a change."""
        in_deviations = _lower_median(np.abs(self._noise.scale(difference)))
        is_like_things = _lower_median(np.abs(difference) / self._spread)[0] < BEYOND_ALL
        return bool(is_like_things and self._have_moved(difference)[0] and in_deviations[0] > CERTAIN)

    def _is_confirmed(self, track: _Track, look: NDArray[np.float32], excess: float) -> bool:
        """Return whether the last look agrees with this one, far more than the nearest known view does."""
        return track.doubtful is not None and self._agrees(track, look, track.doubtful, excess)

    def _agrees(self, track: _Track, look: NDArray[np.float32], other: NDArray[np.float32], excess: float) -> bool:
        """Return whether two looks agree, far more than the first does with the nearest known view."""
        between = self._noise.excess(_differences(look, [other]))[0]
        return bool(between <= min(track.own_noise, AGREEMENT * excess))

    def _have_moved(self, differences: Array) -> NDArray[np.bool_]:
        """Return (k,) booleans: whether (k, m) differences exceed any sensor's noise, as far as that is known."""
        if not self._spread_is_known:
            return np.zeros(len(differences), dtype=bool)
        many: NDArray[np.bool_] = _lower_median(np.abs(differences) / self._spread) > MANY_FEATURES_MOVED
        return many & (self._size(differences) > FAR_IN_ALL)

    def _size(self, differences: Array) -> Array:
        """Return (k,) root mean square of (k, m) differences, in spreads, each of at most `LARGEST_STEP`."""
        steps = np.minimum(np.abs(differences) / self._spread, LARGEST_STEP)
        return np.asarray(np.sqrt(np.mean(steps**2, axis=1)))


def corrected(scenes: Sequence[Scene], corrections: Sequence[Correction]) -> list[Scene]:
    """Return earlier scenes, in their order, with the corrected features; one without a mistake is the same object."""
    found = list(scenes)
    for correction in corrections:
        object_id = correction.object_id
        showing = [i for i, scene in enumerate(found) if object_id in scene.object_ids]
        for i in showing[-1:] if correction.is_of_last_look else showing:
            found[i] = _corrected(found[i], correction)
    return found


def _corrected(scene: Scene, correction: Correction) -> Scene:
    row = scene.index_of(correction.object_id)
    if not np.array_equal(scene.features[row], correction.wrong):
        return scene
    features = scene.features.copy()
    features[row] = correction.right
    return dataclasses.replace(scene, features=features)


def _differences(looks: FloatArray, others: Sequence[FloatArray]) -> Array:
    """Return (k, m) differences between one look, or k looks, and (m,) k others."""
    return np.asarray(np.subtract(looks, np.array(others), dtype=np.float64))


def _lower_median(values: Array) -> Array:
    """Return (k,) the median of each row of (k, m); of an even number, the lower one of the two in the middle."""
    middle = (values.shape[1] - 1) // 2
    return np.asarray(np.partition(values, middle, axis=1)[:, middle])
