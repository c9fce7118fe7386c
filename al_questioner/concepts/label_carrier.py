"""Carrying of labels from the view that was named to the other views of the same object, by its id.

Why the rules are these: docs/explanation/carried_labels.md.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from al_questioner.concepts.seen_views import Compare, SeenViews
from al_questioner.concepts.taught_views import LabelledView, TaughtViews
from al_questioner.domain import NO_SYMBOL, FloatArray, Scene


class LabelCarrier:
    """Carrier of labels: at any time, the carried labels of an object are what was said of it last.

    - A view that has no label gets, when it is seen, what was said last of its object.
    - When an object is named, so are the views of it that were seen before, but only as long as nothing that was said
      of it contradicts.
    - What is said of a view itself takes the place of what was carried to it. If it contradicts what was said of the
      object before, all labels that were carried from there are withdrawn.
    - A name counts more than a judgement of many things at once, as for a single view.

    It knows only what is seen and said since it was made: an object of an earlier episode may have had the same id.

    Args:
        taught: views that were named or judged; labels are carried there.
        are_same: tells whether two looks at an object are the same view.
    """

    def __init__(self, taught: TaughtViews, are_same: Compare) -> None:
        self._taught = taught
        self._are_same = are_same
        self._seen = SeenViews()
        self._said: dict[int, LabelledView] = {}
        self._contradicted: set[int] = set()

    def see(self, object_id: int, features: FloatArray, turn: int) -> None:
        """Take note of a look at an object, (m,) raw features, that differs from the last one."""
        self._seen.add(object_id, features, self._are_same)
        if object_id in self._said:
            self._carry(self._said[object_id], features, turn)

    def label(self, view: LabelledView) -> None:
        """Add a label, see `TaughtViews.label`, and carry it to the other views of the object."""
        self._taught.label(view)
        self._hear(view)

    def judge(self, scene: Scene, mattering: Collection[int], turn: int) -> bool:
        """Add a judgement, see `TaughtViews.judge`; return whether any label has changed."""
        before = set(self._taught.labelled)
        changed = self._taught.judge(scene, mattering, turn)
        for object_id in scene.object_ids:
            said = self._said.get(object_id)
            if object_id in mattering and said is not None and said.was_left_out:
                self._contradicted.add(object_id)
                del self._said[object_id]
                copies = self._copies(object_id)
                self._taught.withdraw(copies, turn)
                changed |= bool(copies)
        for view in [each for each in self._taught.labelled if each not in before]:
            said = self._said.get(view.object_id)
            if said is None or said.was_left_out:
                self._hear(view)
        return changed

    def _hear(self, view: LabelledView) -> None:
        """Take note of a label that was given to a view, and that is learnt already."""
        before = self._said.get(view.object_id)
        if before is not None and before.label != view.label:
            self._contradicted.add(view.object_id)
        copies = self._copies(view.object_id)
        outdated = [
            copy
            for copy in copies
            if copy.label != view.label or bool(self._are_same(copy.features[None], view.features)[0])
        ]
        self._taught.withdraw(outdated, view.turn)
        self._said[view.object_id] = view
        if view.object_id not in self._contradicted:
            for features in self._seen.of_object(view.object_id):
                self._carry(view, features, view.turn)

    def _copies(self, object_id: int) -> list[LabelledView]:
        """Return the labels that were carried to views of an object, and count."""
        return [
            view
            for view in self._taught.labelled
            if view.object_id == object_id and view.is_carried and view.source is not None
        ]

    def _carry(self, said: LabelledView, features: FloatArray, turn: int) -> None:
        """Give what was said to another view, (m,) raw features, if nothing was said of that itself."""
        if self._taught.has_label(said.object_id, features):
            return
        if said.label == NO_SYMBOL and self._taught.was_judged_to_matter(said.object_id, features):
            return
        self._taught.carry(
            LabelledView(
                said.object_id,
                np.array(features, dtype=np.float32),
                said.label,
                turn,
                said.was_left_out,
                is_carried=True,
                source=said,
            )
        )
