"""Parts that all figures share."""

from __future__ import annotations

import os
import subprocess
import sys

from matplotlib import pyplot as plt

from al_questioner.domain import QueryKind
from al_questioner.support.plotting import STYLE, colours_of, new_figure, picture_of, put_legend_below


def test_a_legend_stands_below_the_panels_and_inside_the_picture() -> None:
    """Otherwise it would hide an axis, or be cut off: how wide and high it is depends on the names."""
    with plt.rc_context(STYLE):
        for count in (1, 3, 12):
            figure, axes = plt.subplots(2, 1, figsize=(5, 4))
            for number in range(count):
                axes[0].plot([0, 1], [0, number], label=f'strategy number {number}')
            axes[1].set_xlabel('turn')
            put_legend_below(figure, 4, *axes[0].get_legend_handles_labels())
            figure.canvas.draw()
            (legend,) = figure.legends
            extent = legend.get_window_extent()
            assert len(legend.get_texts()) == count
            assert extent.y0 >= 0
            assert 0 <= extent.x0 < extent.x1 <= figure.bbox.width
            assert extent.y1 <= min(panel.get_tightbbox().y0 for panel in axes)
            plt.close(figure)


def test_a_notebook_keeps_its_way_to_show_figures() -> None:
    """Otherwise a comparison in a notebook would leave the figures of its user invisible."""
    before = plt.get_fignums()
    figure = new_figure(3, 2)
    figure.subplots().plot([0, 1])
    assert picture_of(figure).startswith(b'\x89PNG')
    assert plt.get_fignums() == before
    code = (
        'import al_questioner.experiments.figures, matplotlib, sys\n'
        "print(matplotlib.get_backend(), 'matplotlib.pyplot' in sys.modules)"
    )
    given = {**os.environ, 'MPLBACKEND': 'svg'}
    done = subprocess.run([sys.executable, '-c', code], env=given, capture_output=True, text=True, check=True)
    assert done.stdout == 'svg False\n'


def test_a_figure_shows_the_papers_kinds_and_others_if_they_were_asked() -> None:
    """Otherwise all figures would have an entry for a question that hardly anybody asks."""
    usual = [QueryKind.LABEL, QueryKind.DEMONSTRATION, QueryKind.FEATURE_SUBSET]
    assert list(colours_of([QueryKind.LABEL, QueryKind.NO_QUERY])) == usual
    assert list(colours_of([QueryKind.RELEVANCE])) == [*usual, QueryKind.RELEVANCE]
