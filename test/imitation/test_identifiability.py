"""The weights that no choice depends on are found, and named."""

import numpy as np

from al_questioner.imitation.identifiability import identify


def test_remaining_time_cancels(made):
    """Otherwise its weight would be an accident of the optimiser and be taken for a finding."""
    free = identify([made.synthetic(np.ones(7), 0, 30)])
    assert free.unidentified == free.cancelling == ('remaining_time',)
    assert 'remaining_time: the same for all candidates of every turn' in free.describe()


def test_features_that_vary_only_together_are_named(made):
    """Otherwise their weights could be exchanged for one another at will."""

    def linked(rng):
        table = rng.random((10, 7))
        table[:, 1] = 2 * table[:, 4] + rng.random()
        return table

    demonstration = made.synthetic(np.ones(7), 0, 30, linked)
    free = identify([demonstration])
    assert free.unidentified == ('class_uniformity', 'budget_consumption', 'remaining_time')
    assert 'class_uniformity, budget_consumption: they vary only together' in free.describe()
    weights = np.random.default_rng(1).normal(size=7)
    kept = free.project(weights)
    for step in demonstration.steps:
        np.testing.assert_allclose(step.contrasts @ kept, step.contrasts @ weights, atol=1e-9)
    assert kept[5] == 0.0


def test_the_scripted_expert_leaves_remaining_time_open_only(experts):
    """Otherwise the shipped weights would hold numbers that nobody can know."""
    assert identify(experts).unidentified == ('remaining_time',)


def test_fewer_choices_than_features_are_seen_through(made):
    """Two steps cannot tell seven weights."""
    step = made.synthetic(np.ones(7), 0, 1).steps[0]
    short = type(step)(1, step.actions[:2], step.features[:2], 0)
    free = identify([type(made.synthetic(np.ones(7), 0, 1))('short', None, None, 1, (short,))])
    assert len(free.null_space) == 6
