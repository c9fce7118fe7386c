"""Concepts of a learner with all that they were learnt from, to learn them again when the past is corrected."""

from __future__ import annotations

import copy

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import VIEW_TOLERANCE, ConceptLearner, Selector, ViewMemory
from al_questioner.concepts.view_memory import Correction, corrected
from al_questioner.domain import AUTO, EpisodeSettings, Outcome, QueryKind, QueryRecord, Scene, ViewTolerance
from al_questioner.questioning.initial_concepts import taught_concept_learner
from al_questioner.questioning.query_status import QueryBook
from al_questioner.questioning.reliability import label_beliefs


class ConceptHistory:
    """The concepts of an episode, and the scenes that they come from beside the queries.

    Attributes:
        selector: selects features computationally; None for none.
        concepts: what is known now.
        scenes: those of the turns so far, without the sensors' noise.
        tuned_turns: at whose end the kernel was tuned, as learners of earlier versions could.
        beliefs: by turn, (L,) what was believed of the thing that was named in it, before it was named; of what was
            named in earlier episodes, by `reliability.item_of`.
    """

    def __init__(
        self, settings: EpisodeSettings, view_tolerance: ViewTolerance, selector: Selector | None, queries: QueryBook
    ) -> None:
        tolerance = VIEW_TOLERANCE if view_tolerance == AUTO else view_tolerance
        self.selector = selector
        self._beginning, self._beliefs_before = taught_concept_learner(settings, selector, tolerance)
        self._views = ViewMemory() if view_tolerance == AUTO else None
        self._queries = queries
        self.concepts = self._at_the_beginning()
        self.scenes: list[Scene] = []
        self.tuned_turns: set[int] = set()
        self.beliefs: dict[int, NDArray[np.float64]] = dict(self._beliefs_before)

    @property
    def view_noise(self) -> dict[str, float]:
        """Noise of each feature by its name, as share of its spread among things; empty if it is not estimated."""
        return {} if self._views is None else self._views.noise

    def observe(self, scene: Scene) -> Scene:
        """Learn how the features vary from what is seen now, and return it without the sensors' noise.

        What it shows to have been a wrong look at a thing is corrected in the scenes before.

        Raises:
            SceneError: the scene's features are not those of the scenes before.
        """
        self.concepts.check_features(scene)
        if self._views is not None:
            scene = self._views.steady(scene, self.concepts.spread, self.concepts.are_implausible(scene))
            past = corrected(self.scenes, [each for each in self._views.corrections if self._matters(each)])
            if any(one is not other for one, other in zip(past, self.scenes, strict=True)):
                self.scenes = past
                self._learn_again()
        self.concepts.observe(scene, len(self.scenes) + 1)
        return scene

    def begin_turn(self, scene: Scene) -> None:
        """Take an observed scene for that of the next turn."""
        last = self.scenes[-1] if self.scenes else None
        # A scene that stays is kept once: an episode of a camera would fill the memory.
        self.scenes.append(last if last is not None and last.equals(scene) else scene)

    def learn(self, record: QueryRecord, is_correction: bool) -> None:
        """Learn what came of a query, as if it had been known in the query's turn."""
        # After it was tuned, a turn's answer comes too late for the order in which everything else is learnt.
        if record.turn == len(self.scenes) and not is_correction and record.turn not in self.tuned_turns:
            self._learn(self.concepts, record)
        else:
            self._learn_again()

    def repeat_tuning(self) -> None:
        """Tune the kernel as a learner of an earlier version did at the end of this turn."""
        self.tuned_turns.add(len(self.scenes))
        self.concepts.repeat_tuning()

    def _at_the_beginning(self) -> ConceptLearner:
        """Return a learner of what was known before the first turn."""
        # A selector may be anything, even what cannot be copied.
        return copy.deepcopy(self._beginning, {id(self.selector): self.selector})

    def _matters(self, correction: Correction) -> bool:
        """Return whether something may have been said of the thing when the scene was seen that is corrected."""
        if not correction.is_of_last_look:
            return True
        object_id = correction.object_id
        last = next((t for t in range(len(self.scenes), 0, -1) if object_id in self.scenes[t - 1].object_ids), 0)
        asked = [query.action for query in self._queries.by_id.values() if query.turn == last]
        return any(
            action.object_id == object_id or action.kind in (QueryKind.DEMONSTRATION, QueryKind.RELEVANCE)
            for action in asked
        )

    def _learn(self, concepts: ConceptLearner, record: QueryRecord) -> None:
        """Learn what came of a query, after a note of what was believed of the thing before."""
        scene = self.scenes[record.turn - 1]
        if record.outcome is Outcome.ANSWERED and record.object_id is not None and record.symbol is not None:
            features = scene.features[[scene.index_of(record.object_id)]]
            self.beliefs[record.turn] = label_beliefs(concepts.predict_proba(features)[0])
        concepts.learn(record, scene)

    def _learn_again(self) -> None:
        """Learn the concepts again from the scenes and the records, event by event as it happened."""
        concepts, records = self._at_the_beginning(), {record.turn: record for record in self._queries.records}
        self.beliefs = dict(self._beliefs_before)
        for turn, scene in enumerate(self.scenes, start=1):
            concepts.observe(scene, turn)
            if turn in records:
                self._learn(concepts, records[turn])
            if turn in self.tuned_turns:
                concepts.repeat_tuning()
        self.concepts = concepts
