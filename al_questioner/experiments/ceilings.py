"""Upper limits of a questioner's accuracy; these ceilings know the truth, so they are not strategies."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from al_questioner.questioning import Teacher, TurnContext, UnlabelledFirst, new_concept_learner, symbol_given_object
from al_questioner.simulation import EpisodeResult, Evaluation, SeenWorld, Task, accuracy, play

CEILING_SETTINGS = 'random_fsq'
"""Strategy whose settings the ceilings use: a learner that selects no features computationally."""


class GreedyOracle(UnlabelledFirst):
    """One early feature subset query, then the label after which held-out accuracy is highest, scene by scene.

    It is greedy: a label is judged by its immediate effect. The accuracy is that on the world's second draw of held-out
    observations, not on those of the results. Among equal accuracies, the geometric mean of the probabilities of the
    true symbols decides. As the budget is spread evenly over the scenes, some is left at each change.
    """

    def __init__(self, world: SeenWorld) -> None:
        self._world = world
        self._features, self._labels = world.validation_set

    def score(self, context: TurnContext) -> NDArray[np.float64]:
        """Return (|X|,) rank of each object's label; NaN for labels beyond the scene's share of the budget."""
        ranks = np.full(len(context.scene), np.nan)
        rows = np.flatnonzero(~context.labelled)
        if context.allowance < context.costs.label or not len(rows):
            return ranks
        symbols, scene, truth = context.symbols, context.scene, self._world.truth(context.turn)
        true = np.array([symbols.index(label) for label in self._labels])
        labels = [truth[scene.object_ids[row]] for row in rows]
        after = context.concepts.predict_after_each(scene.features[rows], labels, self._features)
        accuracies = [accuracy(q, self._labels, symbols) for q in after]
        likelihoods = np.mean(np.log(symbol_given_object(after)[:, np.arange(len(true)), true]), axis=1)
        ranks[rows[np.lexsort((likelihoods, accuracies))]] = np.arange(len(rows))
        return ranks


def play_greedy_oracle(evaluation: Evaluation, task: Task, teacher: Teacher) -> EpisodeResult:
    """Play the episode of the `GreedyOracle`.

    Raises:
        InputError: the world has no second draw of held-out observations.
    """
    play(evaluation, GreedyOracle(evaluation.world), teacher)
    return evaluation.result()


def follow_all_labels(evaluation: Evaluation, task: Task, teacher: Teacher) -> EpisodeResult:
    """Play an episode in which the learner gets the relevant features, and every label as soon as it is in view.

    It asks nothing, and pays nothing. No questioner in these scenes can learn more labels; fewer labels, well chosen,
    can be more accurate.
    """
    settings, world = evaluation.settings, evaluation.world
    concepts = new_concept_learner(settings, None)
    for turn in range(1, settings.turns + 1):
        scene = world.scene(turn)
        concepts.observe(scene, turn)
        if task.relevant_groups and not concepts.subset_was_told:
            concepts.restrict_to_groups(task.relevant_groups)
        fresh = [scene.object_ids[row] for row in np.flatnonzero(~concepts.is_labelled(scene))]
        if fresh:
            truth = world.truth(turn)
            concepts.label_scene(scene, {object_id: truth[object_id] for object_id in fresh}, turn)
        evaluation.next_turn(None, concepts)
    return evaluation.result()


CEILINGS: Mapping[str, Callable[[Evaluation, Task, Teacher], EpisodeResult]] = {
    'all_labels': follow_all_labels,
    'greedy_oracle': play_greedy_oracle,
}
"""Functions that play each ceiling, by name."""
