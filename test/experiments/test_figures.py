"""Accuracy against cost, by hand."""

from itertools import product

import numpy as np
import pytest
from matplotlib import image as images
from matplotlib.colors import to_rgb

from al_questioner.experiments.figures import accuracy_by_cost, draw_cost_curves, learning_curves
from al_questioner.experiments.plan import CONTROLS, PAPER_STRATEGIES, PROPOSED, Cell
from al_questioner.experiments.results import EpisodeRow, Results, TurnRow


def test_accuracy_by_cost_by_hand():
    """A cost buys what is known after the last turn that it still pays for, turns without a question included."""
    curves = np.array([[0.2, 0.5, 0.5, 0.8], [0.3, 0.4, 0.6, 0.7]])
    spent = np.array([[1.0, 3.0, 3.0, 4.0], [0.0, 0.0, 0.1 + 0.2, 2.0]])
    found = accuracy_by_cost(curves, spent, np.array([0.0, 0.3, 1.0, 2.0, 3.0, 9.0]))
    np.testing.assert_array_equal(found[0], [0.2, 0.2, 0.2, 0.2, 0.5, 0.8])
    np.testing.assert_array_equal(found[1], [0.4, 0.6, 0.6, 0.7, 0.7, 0.7])


def made(*strategies, budgets=(25.0,)):
    """Results of two samples, three turns long."""
    each = product(strategies, budgets, range(2))
    cells = [Cell('kitchen_table', budget, 3, strategy, sample) for strategy, budget, sample in each]
    turns = [TurnRow(cell, t, t / 5, 'label', '1', 'fruit', 'answered', float(t)) for cell in cells for t in (1, 2, 3)]
    return Results([EpisodeRow(cell, 0.6, 0.4, 3, 3.0) for cell in cells], turns)


def test_the_picture_shows_all_who_ask(tmp_path):
    """Otherwise a user who is told without asking has no costs, and would be drawn at none."""
    path = draw_cost_curves(made('value_per_cost', 'all_labels'), 'kitchen_table', tmp_path / 'new')
    assert path.name == 'accuracy_by_cost_kitchen_table.png'
    assert path.stat().st_size > 10_000


def test_the_strategy_that_is_asked_about_has_a_band():
    """Otherwise the certainty of other strategies would be shown, and not that of the one that matters."""
    results = made('mine', 'random_fsq', 'dt_task')

    def colours_of_bands(compared):
        (panel,) = learning_curves(results, 'kitchen_table', compared).axes
        bands = {tuple(band.get_facecolor()[0][:3]) for band in panel.collections}
        return {line.get_label() for line in panel.lines if to_rgb(line.get_color()) in bands}

    assert colours_of_bands('mine') == {'mine', 'dt_task'}
    assert colours_of_bands(None) == {'dt_task'}


@pytest.mark.parametrize('budgets', [(25.0,), (25.0, 500.0)])
def test_the_legend_is_whole(tmp_path, budgets):
    """Otherwise the names of the strategies at its edges would be cut off: with one panel the picture is narrow."""
    all_of_them = made(*PAPER_STRATEGIES, *PROPOSED, *CONTROLS, budgets=budgets)
    path = draw_cost_curves(all_of_them, 'kitchen_table', tmp_path)
    picture = images.imread(path)[..., :3]
    assert (picture[:, [0, 1, -2, -1]] == 1).all()
