"""Parts that all figures share: a style for print, and a colour for each kind of query."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from al_questioner.domain import Outcome, QueryKind, QueryRecord
from al_questioner.support.files import write_bytes

KIND_COLOURS = {
    QueryKind.LABEL: '#2c6fbb',
    QueryKind.DEMONSTRATION: '#d1622b',
    QueryKind.FEATURE_SUBSET: '#3a923a',
    QueryKind.RELEVANCE: '#8e5ea2',
}
EXTRA_KINDS = (QueryKind.RELEVANCE,)
"""Kinds that figures show only if such a query was asked."""
STYLE: dict[Any, Any] = {
    'axes.spines.top': False,
    'axes.spines.right': False,
    'axes.grid': True,
    'grid.alpha': 0.25,
    'font.size': 11,
    'figure.constrained_layout.use': True,
}
DPI = 150
LEGEND_MARGIN_POINTS = 6
"""Distance between the panels and the legend below them, in points."""


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure of this size in inches.

    It is not one of pyplot's, so a notebook keeps its way to show figures, and nobody has to close this one.
    """
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    return figure


def kind_name(kind: QueryKind) -> str:
    """Return a kind of query in words."""
    return kind.value.replace('_', ' ')


def colours_of(asked: Iterable[QueryKind]) -> dict[QueryKind, str]:
    """Return the colours of the kinds of queries that a figure shows: the paper's, and what else was asked."""
    found = set(asked)
    return {kind: colour for kind, colour in KIND_COLOURS.items() if kind in found or kind not in EXTRA_KINDS}


def mark_changes(axes: Axes, change_turns: tuple[int, ...] | list[int]) -> None:
    """Draw a grey line before each turn that begins with a scene change."""
    for change in change_turns:
        axes.axvline(change - 0.5, color='gray', linewidth=0.9, alpha=0.7, zorder=1)


def mark_query(axes: Axes, record: QueryRecord, height: float) -> None:
    """Draw a dot at the turn of a query, in the colour of its kind; it is hollow if the query got no answer."""
    colour = KIND_COLOURS[record.kind]
    face = colour if record.outcome is Outcome.ANSWERED else 'white'
    axes.scatter(record.turn, height, s=52, facecolor=face, edgecolor=colour, linewidth=1.4, zorder=3)


def put_legend_below(
    figure: Figure, columns: int, handles: Sequence[Artist], labels: Sequence[str], **look: Any
) -> None:
    """Put a legend below all panels, in fewer columns if they would not fit."""
    while True:
        legend = figure.legend(handles, labels, loc='lower center', ncols=columns, frameon=False, **look)
        extent = legend.get_window_extent()
        # The width depends on the names, which other packages may choose.
        if columns == 1 or extent.width <= figure.bbox.width:
            break
        legend.remove()
        columns -= 1
    # The same as `outside lower center`, which matplotlib 3.6 does not have.
    bottom = (extent.height + LEGEND_MARGIN_POINTS * figure.dpi / 72) / figure.bbox.height
    figure.set_layout_engine('constrained', rect=(0, bottom, 1, 1 - bottom))


def picture_of(figure: Figure, kind: str = 'png') -> bytes:
    """Return a figure as the content of a file of this kind."""
    content = io.BytesIO()
    figure.savefig(content, dpi=DPI, format=kind)
    return content.getvalue()


def save(figure: Figure, path: Path) -> Path:
    """Write a figure in the format of the file's suffix.

    Raises:
        InputError: it cannot be written.
    """
    write_bytes(path, picture_of(figure, path.suffix.removeprefix('.')))
    return path
