"""Views of objects of which a teacher said something, and how a scene shows them again."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.seen_views import Compare, SeenViews
from al_questioner.domain import NO_SYMBOL, FloatArray, Scene


@dataclass(frozen=True, eq=False)
class LabelledView:
    """One object that the teacher named: its features, its label, and the turn of the label (0: earlier).

    It was left out if it is an example of `NO_SYMBOL` only because it was not among the things that matter. What is
    known from earlier episodes has a number there. A carried label was said of another view of the object, the source,
    which is None for what is known from earlier episodes.
    """

    object_id: int
    features: NDArray[np.float32]
    label: str
    turn: int
    was_left_out: bool = False
    number: int | None = None
    is_carried: bool = False
    source: LabelledView | None = None

    @property
    def is_inferred(self) -> bool:
        """True if nobody gave this view its label: another statement can take it back."""
        return self.was_left_out or self.is_carried


@dataclass(frozen=True, eq=False)
class WithdrawnView:
    """One view whose inferred label no longer counts, and the turn since when.

    It was left out, and matters; or the label was carried to it, and something else was said of it or its object.
    """

    view: LabelledView
    turn: int


@dataclass(frozen=True, eq=False)
class JudgedView:
    """One object of which the teacher said whether it matters, that is, is of some symbol, and in which turn."""

    object_id: int
    features: NDArray[np.float32]
    matters: bool
    turn: int


@dataclass(frozen=True, eq=False)
class UnnameableView:
    """One object that a teacher was asked to name and could not."""

    object_id: int
    features: NDArray[np.float32]


View = LabelledView | JudgedView | UnnameableView
AnyView = TypeVar('AnyView', LabelledView, JudgedView)


class TaughtViews:
    """Views that were named, judged, or could not be named; of what was said of the same view the last word counts.

    Args:
        are_same: tells whether two looks at an object are the same view.

    Attributes:
        labelled: in the order of the labels; a view can have several.
        judged: with what was said last of each.
        withdrawn: views whose labels no longer count.
        learnt: all labels of this episode in the order in which they came, those that no longer count included.
    """

    def __init__(self, are_same: Compare) -> None:
        self._are_same = are_same
        self.labelled: list[LabelledView] = []
        self.judged: list[JudgedView] = []
        self.withdrawn: list[WithdrawnView] = []
        self.learnt: list[LabelledView] = []
        self._unnameable: list[UnnameableView] = []

    @property
    def labels(self) -> list[str]:
        """Label of each labelled view."""
        return [view.label for view in self.labelled]

    def label(self, view: LabelledView) -> None:
        """Add a label; a view that is of no symbol does not matter, whatever was said before."""
        self._add([view])
        if view.label == NO_SYMBOL:
            _, taken_back = self._pairs(self.judged, (view.object_id,), view.features[None])
            self.judged = _without(self.judged, taken_back)

    def judge(self, scene: Scene, mattering: Collection[int], turn: int) -> bool:
        """Add that some objects of a scene, by their ids, matter, and the others do not.

        The others are examples of `NO_SYMBOL`, unless their views have a label. Return whether any label has changed.
        """
        judged = [
            JudgedView(object_id, np.array(row, dtype=np.float32), object_id in mattering, turn)
            for object_id, row in zip(scene.object_ids, scene.features, strict=True)
        ]
        self._replace_judgements(scene.object_ids, scene.features, judged)
        rows, labels = self._pairs(self.labelled, scene.object_ids, scene.features)
        taken_back = [
            self.labelled[label]
            for row, label in zip(rows, labels, strict=True)
            if judged[row].matters and self.labelled[label].was_left_out
        ]
        self.withdraw(taken_back, turn)
        left_out = [
            LabelledView(view.object_id, view.features, NO_SYMBOL, turn, was_left_out=True)
            for view, times in zip(judged, self.times_labelled(scene), strict=True)
            if not (view.matters or times)
        ]
        self._add(left_out)
        return bool(taken_back or left_out)

    def carry(self, view: LabelledView) -> None:
        """Add a label that was said of another view of the object."""
        self._add([view])

    def withdraw(self, views: Collection[LabelledView], turn: int) -> None:
        """Let labels count no longer, from a turn on."""
        self.withdrawn += [WithdrawnView(view, turn) for view in views]
        self.labelled = [view for view in self.labelled if view not in views]

    def learn_again(
        self, judged: Sequence[JudgedView], labelled: Sequence[LabelledView], withdrawn: Collection[int]
    ) -> None:
        """Add what was said in one turn of an earlier episode, in which the labels of some numbers were withdrawn."""
        if judged:
            features = np.array([view.features for view in judged])
            self._replace_judgements([view.object_id for view in judged], features, judged)
        dropped = [i for i, view in enumerate(self.labelled) if view.is_inferred and view.number in withdrawn]
        self.labelled = _without(self.labelled, dropped)
        for view in labelled:
            if view.is_inferred:
                self._add([view])
            else:
                self.label(view)

    def note_unnameable(self, object_id: int, features: FloatArray) -> None:
        """Add that a teacher could not name an object with these (m,) raw features."""
        self._unnameable.append(UnnameableView(object_id, np.array(features, dtype=np.float32)))

    def times_labelled(self, scene: Scene | SeenViews) -> NDArray[np.intp]:
        """Return (n,) counts: how often this view of each object has been labelled."""
        rows, _ = self._pairs(self.labelled, scene.object_ids, scene.features)
        return np.bincount(rows, minlength=len(scene))

    def labels_of(self, scene: Scene) -> tuple[str | None, ...]:
        """Return the last label of this view of each object; None for a view without one."""
        found: list[str | None] = [None] * len(scene)
        for row, label in zip(*self._pairs(self.labelled, scene.object_ids, scene.features), strict=True):
            found[row] = self.labelled[label].label
        return tuple(found)

    def has_label(self, object_id: int, features: FloatArray) -> bool:
        """Return whether a view of an object, (m,) raw features, has a label."""
        return bool(self._pairs(self.labelled, (object_id,), features[None])[0].size)

    def was_judged_to_matter(self, object_id: int, features: FloatArray) -> bool:
        """Return whether a view of an object, (m,) raw features, was last said to matter."""
        _, judged = self._pairs(self.judged, (object_id,), features[None])
        return any(self.judged[place].matters for place in judged)

    def matters(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n,) booleans: whether this view of each object was last said to matter, and has no label so far."""
        found = np.zeros(len(scene), dtype=bool)
        for row, view in zip(*self._pairs(self.judged, scene.object_ids, scene.features), strict=True):
            found[row] = self.judged[view].matters
        matter: NDArray[np.bool_] = found & (self.times_labelled(scene) == 0)
        return matter

    def is_unnameable(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n,) booleans: whether a teacher was asked to name this view of each object and did not know."""
        rows, _ = self._pairs(self._unnameable, scene.object_ids, scene.features)
        return np.bincount(rows, minlength=len(scene)) > 0

    def _add(self, views: Sequence[LabelledView]) -> None:
        self.labelled += views
        self.learnt += [view for view in views if view.number is None]

    def _replace_judgements(
        self, object_ids: Sequence[int], features: FloatArray, judged: Sequence[JudgedView]
    ) -> None:
        """Add judgements of objects with (n, m) raw features in place of those of the same views before."""
        _, before = self._pairs(self.judged, object_ids, features)
        self.judged = [*_without(self.judged, before), *judged]

    def _pairs(
        self, views: Sequence[View], object_ids: Sequence[int], features: FloatArray
    ) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Return the rows of objects, with (n, m) raw features, that show one of the views, and the index of that view.

        The result is in the order of the rows, and for each row in that of the views.
        """
        ids = np.array([view.object_id for view in views], dtype=np.intp)
        rows, among = np.nonzero(np.array(object_ids, dtype=np.intp)[:, None] == ids)
        known = np.array([views[int(i)].features for i in among], dtype=np.float32)
        same = self._are_same(known.reshape(len(among), features.shape[1]), features[rows])
        return rows[same], among[same]


def _without(views: Sequence[AnyView], places: Collection[int] | NDArray[np.intp]) -> list[AnyView]:
    """Return the views but for those at these places."""
    dropped = set(places)
    return [view for place, view in enumerate(views) if place not in dropped]
