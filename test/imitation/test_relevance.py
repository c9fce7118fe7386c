"""Demonstrations in which it was asked which things matter, a question that no trained strategy knows."""

import dataclasses

import numpy as np
import pytest

from al_questioner.domain import Action, Costs, QueryKind, random_stream
from al_questioner.imitation.demonstration import steps_of
from al_questioner.questioning import FEATURE_SETS, Choice, Episode, FeatureRecorder
from al_questioner.questioning.strategies.expected_utility import expected_features
from shared.toys import toy as toy

RELEVANCE = Action(QueryKind.RELEVANCE)


class Expert:
    """Asks first which things matter, or which properties, and then for the first thing's name."""

    selector = None

    def choose(self, context, rng):
        first = RELEVANCE if RELEVANCE in context.candidates else Action(QueryKind.FEATURE_SUBSET)
        wanted = first if context.turn == 1 else Action(QueryKind.LABEL, context.scene.object_ids[0])
        return Choice(context.candidates.index(wanted), np.zeros(len(context.candidates)))


@pytest.mark.parametrize('name', [name for name, each in FEATURE_SETS.items() if each.passed_over])
def test_what_the_strategy_passes_over_teaches_it_nothing(toy, name):
    """Weights would be fitted to a choice that the strategy never makes, and that its features say nothing of."""
    feature_set, steps = FEATURE_SETS[name], {}
    for costs in (Costs(), Costs(relevance=0.0)):
        settings = toy.settings('human', turns=6, costs=costs)
        episode = Episode(settings, random_stream(1, 'x'), strategy=FeatureRecorder(Expert(), feature_set))
        decisions = toy.play(episode, toy.world(3))
        steps[costs.relevance] = steps_of(decisions, feature_set.passed_over)
    assert [step.turn for step in steps[None]] == [1, 2, 3, 4, 5, 6]
    assert [step.turn for step in steps[0.0]] == [2, 3, 4, 5, 6]
    assert not any(RELEVANCE in step.actions for step in steps[0.0])
    for step in steps[0.0]:
        assert step.actions[step.chosen] == Action(QueryKind.LABEL, step.actions[step.chosen].object_id)
        assert step.features.shape == (len(step.actions), len(feature_set.names))


def test_the_expected_features_are_those_of_learning_nothing_at_a_price(toy):
    """Otherwise more would be recorded of the candidate than the model can say of it."""
    context = toy.context(['snack', 'fruit'], costs=Costs(relevance=4.0))
    without = dataclasses.replace(context, costs=Costs())
    features, row = expected_features(context), context.candidates.index(RELEVANCE)
    nothing = features[-1].copy()
    np.testing.assert_array_equal(features[row, :4], nothing[:4])
    assert features[row, 4] == pytest.approx((context.spent + 4) / context.budget)
    assert features[row, 6] == 0
    np.testing.assert_array_equal(np.delete(features, row, axis=0), expected_features(without))
