"""Accuracy against cost, by hand."""

import numpy as np

from al_questioner.experiments.figures import accuracy_by_cost, draw_cost_curves
from al_questioner.experiments.plan import Cell
from al_questioner.experiments.results import EpisodeRow, Results, TurnRow


def test_accuracy_by_cost_by_hand():
    """A cost buys what is known after the last turn that it still pays for, turns without a question included."""
    curves = np.array([[0.2, 0.5, 0.5, 0.8], [0.3, 0.4, 0.6, 0.7]])
    spent = np.array([[1.0, 3.0, 3.0, 4.0], [0.0, 0.0, 0.1 + 0.2, 2.0]])
    found = accuracy_by_cost(curves, spent, np.array([0.0, 0.3, 1.0, 2.0, 3.0, 9.0]))
    np.testing.assert_array_equal(found[0], [0.2, 0.2, 0.2, 0.2, 0.5, 0.8])
    np.testing.assert_array_equal(found[1], [0.4, 0.6, 0.6, 0.7, 0.7, 0.7])


def test_the_picture_shows_all_who_ask(tmp_path):
    """Of two experiments side by side; who is told without asking has no costs."""

    def made(strategy):
        cells = [Cell('kitchen_table', 25.0, 3, strategy, sample) for sample in range(2)]
        turns = [
            TurnRow(cell, t, 0.2 * t, 'label', '1', 'fruit', 'answered', float(t)) for cell in cells for t in (1, 2, 3)
        ]
        return Results([EpisodeRow(cell, 0.6, 0.4, 3, 3.0) for cell in cells], turns)

    both = made('value_per_cost').beside(made('all_labels'))
    assert both.strategies == ('value_per_cost', 'all_labels')
    (path,) = draw_cost_curves(both, tmp_path / 'new')
    assert path.name == 'accuracy_by_cost_kitchen_table.png'
    assert path.stat().st_size > 10_000
