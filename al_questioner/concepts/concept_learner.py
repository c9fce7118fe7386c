"""Record of all that the learner has been taught, and the models that follow from it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts.concept_models import ConceptModels
from al_questioner.concepts.feature_selection import Selector, select_features
from al_questioner.concepts.feature_space import VIEW_TOLERANCE, FeatureSpace
from al_questioner.concepts.kernel import RBF, Kernel, KernelShape
from al_questioner.concepts.label_carrier import LabelCarrier
from al_questioner.concepts.laplace.earlier_tuning import tuned_kernels
from al_questioner.concepts.last_looks import LastLooks
from al_questioner.concepts.seen_views import SeenViews
from al_questioner.concepts.standardiser import Standardiser
from al_questioner.concepts.taught_views import JudgedView, LabelledView, TaughtViews, WithdrawnView
from al_questioner.domain import (
    FloatArray,
    Outcome,
    QueryKind,
    QueryRecord,
    Scene,
)
from al_questioner.support.arrays import Array


class ConceptLearner:
    """Concept models of all that was observed and taught: a deterministic function of the events, in their order.

    The features are standardised with the observed views. They are restricted to those that the teacher called
    relevant, and, if there is a selector, to those that it selects from the labels so far. Models are fitted at every
    event.

    Args:
        symbols: the concepts to ground.
        amplitude: variance of the Gaussian processes' kernel.
        length_scale: length scale of the kernel in standard deviations; None for the square root of the number of
            features in use.
        selector: selects features computationally after every label; None for all that the teacher has not ruled out.
        view_tolerance: largest change of an object's features in the same view; root mean square over the features, in
            standard deviations. The default allows rounding only.
        shape: how the kernel treats groups of features and single large differences.
        class_balance: how much of the effect of the counts of examples is removed from the degrees, 0 to 1.

    Attributes:
        seen: the distinct views that were observed.
    """

    def __init__(
        self,
        symbols: Sequence[str],
        amplitude: float,
        length_scale: float | None = None,
        selector: Selector | None = None,
        view_tolerance: float = VIEW_TOLERANCE,
        shape: KernelShape = RBF,
        class_balance: float = 0.0,
    ) -> None:
        self.symbols = tuple(symbols)
        self.seen = SeenViews()
        self._space = FeatureSpace(selector, view_tolerance)
        self._taught = TaughtViews(self._space.are_same)
        self._listener: TaughtViews | LabelCarrier = self._taught
        self._carrier: LabelCarrier | None = None
        self._models = ConceptModels(self.symbols, amplitude, length_scale, shape=shape, class_balance=class_balance)
        self._configured = self._models.kernels
        self._last_looks = LastLooks()
        self._version = 0

    @property
    def feature_names(self) -> tuple[str, ...]:
        """Names of all features; none before the first scene."""
        return self._space.names

    @property
    def groups(self) -> tuple[str, ...]:
        """Groups of all features, in the order in which they occur; none before the first scene."""
        return self._space.groups

    @property
    def labelled_views(self) -> Sequence[LabelledView]:
        """Examples, in the order in which they were learnt."""
        return self._taught.labelled

    @property
    def judged_views(self) -> Sequence[JudgedView]:
        """Views of which it is known whether they matter, with what was said last."""
        return self._taught.judged

    @property
    def withdrawn_views(self) -> Sequence[WithdrawnView]:
        """Labels that no longer count, with the turn since when."""
        return self._taught.withdrawn

    @property
    def learnt_labels(self) -> Sequence[LabelledView]:
        """All labels of this episode in the order in which they came, those that no longer count included."""
        return self._taught.learnt

    @property
    def positives(self) -> dict[str, int]:
        """Number of positive examples of each symbol, in the order of the symbols."""
        labels = self._taught.labels
        return {symbol: labels.count(symbol) for symbol in self.symbols}

    @property
    def model_version(self) -> int:
        """Number of events that required new models.

        It counts events and not fits, so that reading the models between events does not change it.
        """
        return self._version

    @property
    def subset_was_told(self) -> bool:
        """True if the teacher has said which features are relevant."""
        return self._space.subset_was_told

    @property
    def standardiser(self) -> Standardiser:
        """Statistics of the observed views, to look at."""
        return self._space.standardiser

    @property
    def features_in_use(self) -> tuple[str, ...]:
        """Names of the features that the models use."""
        return self._space.names_in_use

    @property
    def kernel(self) -> Kernel:
        """Kernel of the models, for the features in use; its length scale is in standard deviations."""
        return self._models.kernels.kernel_of(len(self.features_in_use))

    def repeat_tuning(self) -> bool:
        """Replace the kernel by the one that a learner of an earlier version found; this is an event too.

        It is the one that explains the labels so far best, see `tuned_kernels`. It depends on the labels, the features
        in use and the configured kernel, not on earlier results.

        Returns:
            Whether the kernel has changed. If it has not, nothing has changed, and the version is the same.
        """
        if not self.labelled_views:
            return False
        points = self.points_of(self._labelled_features())
        found = tuned_kernels(points, self._models.targets_of(self._taught.labels), self._configured)
        if found == self._models.kernels:
            return False
        self._models = self._models.with_kernel(found.amplitude, found.relative_length_scale)
        self._fit_models()
        return True

    @property
    def spread(self) -> Array:
        """Spread of each feature among the observed views, (m,) in its own unit; empty before the first scene."""
        return self._space.standardiser.spread

    def implausible_readings(self, scene: Scene) -> list[tuple[int, str, float]]:
        """Return object id, feature name and value of each implausible reading of a scene, see `PlausibleRange`.

        For an object that was seen before, such a reading is ignored. For a new object, it counts as the end of the
        range.
        """
        return self._space.implausible_readings(scene)

    def are_implausible(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n, m) booleans: the implausible readings of a scene, judged by the earlier views."""
        return self._space.are_implausible(scene)

    def check_features(self, scene: Scene) -> None:
        """Make sure that a scene has the features of the earlier scenes.

        Raises:
            SceneError: it has others.
        """
        self._space.check(scene)

    def carry_labels(self) -> None:
        """Let what is said of an object from now on count for all views of it that are seen from now on."""
        self._listener = self._carrier = LabelCarrier(self._taught, self._space.are_same)

    def observe(self, scene: Scene, turn: int = 0, carried: Sequence[LabelledView] = ()) -> None:
        """Update the features' statistics with a scene; a view that is already known is not counted again.

        Args:
            scene: what is seen.
            turn: of the scene; only where labels are carried it has to be given.
            carried: labels that the views of the scene got by this, in an earlier episode that is learnt again.

        Raises:
            SceneError: the features are not those of the earlier scenes.
            InputError: a label that cannot be learnt.
        """
        self._space.admit(scene)
        new = self._last_looks.take(scene.object_ids, scene.features)
        if new:
            self._space.standardiser.update(scene.features[new])
        for row in new:
            self.seen.add(scene.object_ids[row], scene.features[row], self._space.are_same)
            if self._carrier is not None:
                self._carrier.see(scene.object_ids[row], scene.features[row], turn)
        for view in carried:
            self._check(view)
            self._taught.carry(view)
        if new or carried:
            self._fit_models()

    def label(self, object_id: int, features: FloatArray, symbol: str, turn: int) -> None:
        """Learn that an object, with (m,) raw features as it looked then, is an example of a symbol or `NO_SYMBOL`.

        Raises:
            InputError: an unknown symbol, or features that do not fit those observed.
        """
        self._label([self._labelled_view(object_id, features, symbol, turn)])

    def label_scene(self, scene: Scene, symbols: Mapping[int, str], turn: int) -> None:
        """Learn the labels, symbols or `NO_SYMBOL` by object id, of several objects of a scene at once.

        Raises:
            InputError: an object is not in the scene, a symbol is unknown, or features do not fit those observed.
        """
        rows = {object_id: scene.features_of(object_id) for object_id in symbols}
        self._label([self._labelled_view(each, row, symbols[each], turn) for each, row in rows.items()])

    def learn(self, record: QueryRecord, scene: Scene) -> None:
        """Learn the result of a query about a scene; an answer without a name does not change the models.

        Raises:
            InputError: the object is not in the scene, or a symbol or feature group is unknown.
        """
        if record.groups:
            self.restrict_to_groups(record.groups)
        elif record.objects is not None:
            self.judge_scene(scene, record.objects, record.turn)
        elif record.kind is QueryKind.LABEL and record.outcome is Outcome.UNKNOWN and record.object_id is not None:
            self.note_unnameable(record.object_id, scene.features_of(record.object_id))
        elif record.object_id is not None and record.symbol is not None:
            self.label(record.object_id, scene.features_of(record.object_id), record.symbol, record.turn)

    def judge_scene(self, scene: Scene, mattering: Collection[int], turn: int) -> None:
        """Learn which objects of a scene matter, by their ids: these are of some symbol, all others of none.

        The others are examples of `NO_SYMBOL` from now on, unless their views have a label. What was said of the same
        views before no longer counts.

        Raises:
            InputError: an object is not in the scene.
        """
        for object_id in mattering:
            scene.features_of(object_id)
        if self._listener.judge(scene, mattering, turn):
            self._fit_models()

    def learn_views(
        self, judged: Sequence[JudgedView], labelled: Sequence[LabelledView], withdrawn: Collection[int] = ()
    ) -> None:
        """Learn again what was said in one turn of an earlier episode, whether the views are in view now or not.

        Args:
            judged: views that were judged.
            labelled: views that got a label.
            withdrawn: numbers of views that mattered, and whose labels as left out no longer counted.

        Raises:
            InputError: an unknown symbol, or features that do not fit those observed.
        """
        for view in labelled:
            self._check(view)
        self._taught.learn_again(judged, labelled, withdrawn)
        if labelled or withdrawn:
            self._fit_models()

    def note_unnameable(self, object_id: int, features: FloatArray) -> None:
        """Note that a teacher could not name an object with these (m,) raw features; the models stay as they are."""
        self._taught.note_unnameable(object_id, features)

    def restrict_to_groups(self, groups: Iterable[str]) -> None:
        """Use the features of these groups only, as the answer to a feature subset query.

        Raises:
            InputError: no group, or an unknown one.
        """
        self._space.restrict_to_groups(groups)
        self._fit_models()

    def predict_proba(self, features: FloatArray) -> Array:
        """Return (k, |Y|) q_y(x) of (k, m) raw features."""
        return self._models.predict_proba(self.points_of(features))

    def look_ahead(self, scene: Scene) -> Array:
        """Return (|X|, |Y|, |X|, |Y|): [i, j] is the prediction for the scene if object i were labelled symbol j."""
        return self._models.look_ahead(self.points_of(scene.features))

    def look_ahead_chunks(self, scene: Scene) -> Iterator[tuple[slice, Array]]:
        """Yield `look_ahead` in parts: consecutive rows of the table, as a slice, and their part of it."""
        return self._models.look_ahead_chunks(self.points_of(scene.features))

    def predict_after_each(self, views: FloatArray, symbols: Sequence[str], features: FloatArray) -> Array:
        """Return (e, k, |Y|) q_y(x) of (k, m) raw features if each of (e, m) views, alone, had this label."""
        return self._models.predict_after_each(self.points_of(views), symbols, self.points_of(features))

    def predict_after_selection(self, scene: Scene) -> Array:
        """Return (|X|, |Y|) prediction for the scene if the teacher named the features that a selector selects.

        It stands in for the answer to a feature subset query, which the learner cannot know
        (docs/explanation/method.md).
        """
        views = self._labelled_features()
        space = self._space.selected_by(select_features, views, self._taught.labels)
        models = self._models.refitted(space.points_of(views), space.groups_in_use)
        return models.predict_proba(space.points_of(scene.features))

    def predict_each_from_others(self) -> Array:
        """Return the (n, |Y|) q_y(x) of the n labelled views, each as if it had not been labelled."""
        return self._models.predict_each_from_others()

    def points_of(self, features: FloatArray) -> Array:
        """Return (k, number in use) features in use, in standard deviations, of (k, m) raw features."""
        return self._space.points_of(features)

    def is_labelled(self, scene: Scene | SeenViews) -> NDArray[np.bool_]:
        """Return (n,) booleans: whether this view of each object has been labelled already, as a symbol or as none."""
        return self.times_labelled(scene) > 0

    def labelled_ids(self, scene: Scene) -> tuple[int, ...]:
        """Return the ids of the objects of which this view has been labelled already."""
        return tuple(scene.object_ids[row] for row in np.flatnonzero(self.is_labelled(scene)))

    def times_labelled(self, scene: Scene | SeenViews) -> NDArray[np.intp]:
        """Return (n,) counts: how often this view of each object has been labelled."""
        return self._taught.times_labelled(scene)

    def labels_of(self, scene: Scene) -> tuple[str | None, ...]:
        """Return the last label of this view of each object; None for a view without one."""
        return self._taught.labels_of(scene)

    def matters(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n,) booleans: whether this view of each object was last said to matter, and has no label so far."""
        return self._taught.matters(scene)

    def is_unnameable(self, scene: Scene) -> NDArray[np.bool_]:
        """Return (n,) booleans: whether a teacher was asked to name this view of each object and did not know."""
        return self._taught.is_unnameable(scene)

    def is_unchanged(self, before: Scene, after: Scene) -> bool:
        """Return whether two scenes show the same views of the same objects."""
        return set(before.object_ids) == set(after.object_ids) and self._show_same(before, after, after.object_ids)

    def still_shows(self, object_id: int, before: Scene, after: Scene) -> bool:
        """Return whether an object is seen in both scenes as the same view."""
        return object_id in after.object_ids and self._show_same(before, after, (object_id,))

    def distance_to_labelled(self, scene: Scene) -> Array:
        """Return (n,) distances to the nearest labelled view; 0 without labels. See `distances_to_labelled`."""
        if not self.labelled_views:
            return np.zeros(len(scene))
        return np.asarray(self.distances_to_labelled(scene).min(axis=1))

    def distances_to_labelled(self, scene: Scene) -> Array:
        """Return (n, number of labelled views) distances of each object to each labelled view, in the features in use.

        In standard deviations, as root mean square over the features.
        """
        return self._space.distances(scene.features, self._labelled_features())

    def distances_to_mattering(self, scene: Scene) -> Array:
        """Return (n, k) distances of each object to each of the k views that were said to matter, likewise."""
        mattering = [view.features for view in self.judged_views if view.matters]
        return self._space.distances(scene.features, self._space.table_of(mattering))

    def _label(self, views: Iterable[LabelledView]) -> None:
        for view in views:
            self._listener.label(view)
        self._fit_models()

    def _labelled_view(self, object_id: int, features: FloatArray, symbol: str, turn: int) -> LabelledView:
        view = LabelledView(object_id, np.array(features, dtype=np.float32), symbol, turn)
        self._check(view)
        return view

    def _check(self, view: LabelledView) -> None:
        self._models.check_labels((view.label,))
        self._space.check_view(view.object_id, view.features)

    def _fit_models(self) -> None:
        """Fit the models to all that is known now.

        This is done after every event, never on demand. A fit starts from the last one, so that fits at other moments
        would differ in the last digits, and ties could be broken in another way.
        """
        self._version += 1
        views, labels = self._labelled_features(), self._taught.labels
        self._space.select(views, labels)
        self._models.fit(self.points_of(views), labels, self._space.groups_in_use)

    def _labelled_features(self) -> Array:
        return self._space.table_of([view.features for view in self.labelled_views])

    def _show_same(self, before: Scene, after: Scene, object_ids: Sequence[int]) -> bool:
        then, now = (scene.features[[scene.index_of(each) for each in object_ids]] for scene in (before, after))
        return bool(self._space.are_same(then, now).all())
