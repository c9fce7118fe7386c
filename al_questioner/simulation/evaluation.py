"""Accuracy of the learner during an episode.

Accuracy is measured outside of the learner: models of the same answers are tested on observations that the learner
never sees. For a learner in another process, the evaluation fits models of its own, which are the same to the last bit.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import ConceptLearner, Kernel, Selector
from al_questioner.domain import EpisodeSettings, QueryRecord
from al_questioner.questioning import new_concept_learner
from al_questioner.simulation.perceived_world import PerceivedWorld
from al_questioner.simulation.world import SeenWorld
from al_questioner.simulation.world_spec import WorldSpec


def accuracy(probabilities: NDArray[np.float64], labels: Sequence[str], symbols: Sequence[str]) -> float:
    """Return the share of observations whose most probable symbol is the true one.

    Args:
        probabilities: (k, |Y|) q_y(x).
        labels: the k true symbols.
        symbols: the |Y| symbols in the order of the columns.

    Returns:
        A number in [0, 1]. If several symbols are the most probable, the true one among them counts as the share
        that guessing among them would get, so that a learner that knows nothing is at chance.
    """
    truth = np.array([symbols.index(label) for label in labels])
    probabilities = np.asarray(probabilities)
    largest = probabilities == probabilities.max(axis=1, keepdims=True)
    tied = largest.sum(axis=1)[largest[np.arange(len(truth)), truth]]
    # In fractions: the sum of floating-point thirds would depend on the order of the observations.
    hits = sum(Fraction(int(count), ties) for ties, count in enumerate(np.bincount(tied)) if count)
    return float(Fraction(hits) / len(truth))


@dataclass(frozen=True)
class EpisodeResult:
    """Result of an episode.

    Attributes:
        world_spec, settings: world and settings of the episode.
        queries: every query, in order.
        accuracy: on the held-out observations, after each turn.
        test_size: number of held-out observations.
        kernel: kernel of the learner's models after the last turn.
    """

    world_spec: WorldSpec
    settings: EpisodeSettings
    queries: tuple[QueryRecord, ...]
    accuracy: tuple[float, ...]
    test_size: int
    kernel: Kernel

    @property
    def spent(self) -> float:
        """Amount of the budget that the queries cost."""
        return float(sum(record.cost for record in self.queries))

    @property
    def final_accuracy(self) -> float:
        """Accuracy after the last turn."""
        return self.accuracy[-1]


class Evaluation:
    """Evaluation that follows an episode turn by turn and measures accuracy on held-out observations.

    Args:
        world_spec: of the world of the episode.
        settings: settings of the episode.
        selector: selects features computationally, as the strategy of the episode does; None for none.
        world: that world, if it is open already: episodes that share it draw and measure every view once.
        tuned_turns: turns at whose end the kernel was tuned, as learners of earlier versions could.
    """

    def __init__(
        self,
        world_spec: WorldSpec,
        settings: EpisodeSettings,
        selector: Selector | None,
        world: SeenWorld | None = None,
        tuned_turns: Collection[int] = (),
    ) -> None:
        self.world_spec = world_spec
        self.settings = settings
        self.world: SeenWorld = PerceivedWorld(world_spec.open()) if world is None else world
        self._selector, self._tuned_turns = selector, tuned_turns
        self._concepts = new_concept_learner(settings, selector)
        self._features, self._labels = self.world.test_set
        self._queries: list[QueryRecord] = []
        self._accuracy: list[float] = []
        self._measured_version = -1

    @property
    def concepts(self) -> ConceptLearner:
        """Concepts after the last turn: the learner's own, or those that this evaluation has learnt like it."""
        return self._concepts

    @property
    def turn(self) -> int:
        """Last turn that was followed."""
        return len(self._accuracy)

    def next_turn(self, record: QueryRecord | None, concepts: ConceptLearner | None = None) -> float:
        """Return the accuracy after one more turn.

        Args:
            record: the query of the turn and its result, None if nothing was asked.
            concepts: the learner's concepts after the turn, if they are available, the same object at every turn;
                otherwise the evaluation learns the same.
        """
        if record is not None:
            self._queries.append(record)
        if concepts is None:
            self._follow(record)
        else:
            self._concepts = concepts
        if self._concepts.model_version == self._measured_version:
            self._accuracy.append(self._accuracy[-1])
        else:
            probabilities = self._concepts.predict_proba(self._features)
            self._accuracy.append(accuracy(probabilities, self._labels, self.settings.symbols))
            self._measured_version = self._concepts.model_version
        return self._accuracy[-1]

    def correct(self, queries: Sequence[QueryRecord]) -> None:
        """Include later answers to queries of turns that were followed already.

        If they change a turn, accuracy is measured again in every turn, as if the answers had come at once. Results of
        future turns are ignored.
        """
        followed = [record for record in queries if record.turn <= self.turn]
        if followed == self._queries:
            return
        turns, by_turn = self.turn, {record.turn: record for record in followed}
        self._concepts = new_concept_learner(self.settings, self._selector)
        self._queries, self._accuracy, self._measured_version = [], [], -1
        for turn in range(1, turns + 1):
            self.next_turn(by_turn.get(turn))

    def result(self) -> EpisodeResult:
        """Return the result of the episode so far."""
        return EpisodeResult(
            self.world_spec,
            self.settings,
            tuple(self._queries),
            tuple(self._accuracy),
            len(self._labels),
            self._concepts.kernel,
        )

    def _follow(self, record: QueryRecord | None) -> None:
        scene = self.world.scene(self.turn + 1)
        self._concepts.observe(scene, self.turn + 1)
        if record is not None:
            self._concepts.learn(record, scene)
        if self.turn + 1 in self._tuned_turns:
            self._concepts.repeat_tuning()
