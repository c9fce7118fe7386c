"""The ceilings: what they know, and that they are worth the name."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
import pytest

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import InputError, Outcome, QueryKind, QueryRecord
from al_questioner.experiments.ceilings import GreedyOracle, follow_all_labels
from al_questioner.experiments.plan import Cell, Variation
from al_questioner.experiments.playing import play_episode
from al_questioner.questioning import TurnContext, new_concept_learner
from al_questioner.simulation import Evaluation, PerceivedWorld, WorldSpec, accuracy, episode_settings
from shared.lunches import TASK, teacher_of
from shared.scenes import make_context, make_scene

SYMBOLS = ('snack', 'fruit')


class ToyWorld:
    """Four things on a line, snacks to the left; held-out things to both sides, most of them fruit."""

    scene_now = make_scene([[-2, 0], [-1, 0], [1, 0], [2, 0]], None, ('colour_red', 'size_height'))
    labels = MappingProxyType(dict(enumerate(['snack', 'snack', 'fruit', 'fruit'])))
    validation_set = np.array([[-2.2, 0], [1.4, 0], [1.8, 0], [2.1, 0]], dtype=np.float32), (
        'snack', 'fruit', 'fruit', 'fruit',
    )  # fmt: skip

    def truth(self, turn: int) -> Mapping[int, str]:
        return self.labels


def context(told: Mapping[int, str], **changes: object) -> TurnContext:
    scene = ToyWorld.scene_now
    concepts = ConceptLearner(SYMBOLS, 4.0)
    concepts.observe(scene)
    for object_id, label in told.items():
        concepts.label(object_id, scene.features[object_id], label, 1)
    asked = QueryRecord(1, QueryKind.FEATURE_SUBSET, None, None, 2.0, Outcome.UNKNOWN)
    return make_context(scene, concepts, history=(asked,), **changes)


def test_the_oracle_takes_the_label_that_leads_to_the_highest_accuracy() -> None:
    """Brute force: teach each label to a learner of its own, and look."""
    told = {0: 'snack'}
    oracle = GreedyOracle(ToyWorld())
    features, labels = ToyWorld.validation_set
    reached = {}
    for object_id in (1, 2, 3):
        taught = context({**told, object_id: ToyWorld.labels[object_id]}).concepts
        q = taught.predict_proba(features)
        p = q / q.sum(axis=1, keepdims=True)
        true = [SYMBOLS.index(label) for label in labels]
        reached[object_id] = accuracy(q, labels, SYMBOLS), float(np.mean(np.log(p[range(4), true])))
    best = max(reached, key=reached.__getitem__)
    now = context(told)
    choice = oracle.choose(now, np.random.default_rng(0))
    assert now.candidates[choice.index].object_id == best


def test_the_oracle_asks_no_view_twice_and_spreads_its_budget() -> None:
    """Otherwise it would spend all on the first scenes and be no ceiling where the budget is short."""
    oracle = GreedyOracle(ToyWorld())
    everything = context(ToyWorld.labels)
    assert np.isnan(oracle.score(everything)).all()
    # Four scenes in twenty turns: five of twenty may be spent in the first.
    assert not np.isnan(oracle.score(context({}, spent=4.0))).all()
    assert np.isnan(oracle.score(context({}, spent=4.5))).all()
    assert not np.isnan(oracle.score(context({}, spent=4.5, turn=6))).all()


def test_the_oracle_needs_a_second_draw(tmp_path) -> None:
    """Otherwise it would be judged by what it was chosen with."""

    class NoSecondDraw(ToyWorld):
        @property
        def validation_set(self):
            raise InputError('no second draw')

    with pytest.raises(InputError, match='no second draw'):
        GreedyOracle(NoSecondDraw())


def test_all_labels_are_all_that_was_in_sight() -> None:
    """Otherwise the ceiling would know too little, or what lies in the future."""
    world_spec = WorldSpec(TASK, 3, 3)
    settings = episode_settings(TASK, 'random_fsq', 25, 12)
    result = follow_all_labels(Evaluation(world_spec, settings, None), TASK, teacher_of(TASK, 3))
    assert result.queries == ()
    assert len(set(result.accuracy[:10])) == 1
    world = PerceivedWorld(world_spec.open())
    concepts = new_concept_learner(settings, None)
    for turn in (1, 11):
        scene = world.scene(turn)
        concepts.observe(scene)
        concepts.restrict_to_groups(TASK.relevant_groups)
        for object_id, labelled in zip(scene.object_ids, concepts.is_labelled(scene), strict=True):
            if not labelled:
                row = scene.features[scene.index_of(object_id)]
                concepts.label(object_id, row, world.truth(turn)[object_id], turn)
        features, labels = world.test_set
        assert result.accuracy[turn - 1] == accuracy(concepts.predict_proba(features), labels, TASK.symbols)


def test_the_oracle_keeps_to_budget_and_time() -> None:
    """A ceiling that pays more than the others is none."""
    cell = Cell('prepare_lunch', 8, 12, 'greedy_oracle', 0)
    result = play_episode(cell, Variation())
    assert 0 < result.spent <= 8
    assert result.queries[0].kind is QueryKind.FEATURE_SUBSET
    assert {record.kind for record in result.queries[1:]} == {QueryKind.LABEL}
    other = dataclasses.replace(cell, strategy='all_labels')
    assert play_episode(other, Variation()).spent == 0
