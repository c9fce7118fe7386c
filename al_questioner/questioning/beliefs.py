"""Probability that an object is of each symbol, or of none, judged by the labels so far.

The classifiers distinguish symbols, but do not recognise objects of no symbol: far from their labels they return 1/2.
The value of a question depends on that, so here the labels vote, beside the classifiers. The derivation is in
docs/explanation/value_per_cost.md.
"""

from __future__ import annotations

import numpy as np

from al_questioner.domain import NO_SYMBOL, Outcome, QueryKind
from al_questioner.questioning.turn_context import TurnContext
from al_questioner.support.arrays import Array


def class_beliefs(context: TurnContext, reach: float, doubt: float) -> Array:
    """Return (|X|, |Y| + 1) probability that an object is of each symbol, or, last, of none.

    For each symbol, the nearest labelled view votes with exp(-d^2 / (2 reach^2)), and `doubt` votes are shared among
    all as in `prior_beliefs` (docs/explanation/value_per_cost.md). If a symbol was asked for
    in this scene and the teacher showed nothing, no object of the scene is of that symbol. The nearest view that was
    said to matter votes likewise, for all symbols in proportion to their votes; one that was said to matter itself is
    not of none. The reach is in standard deviations of a feature, root mean square; the doubt is above 0.
    """
    votes = doubt * prior_beliefs(context)
    labels = np.array([view.label for view in context.concepts.labelled_views], dtype=object)
    nearness = _nearness(context.concepts.distances_to_labelled(context.scene), reach)
    for column, name in enumerate((*context.symbols, NO_SYMBOL)):
        votes[:, column] += nearness[:, labels == name].max(axis=1, initial=0.0)
    votes[:, [context.symbols.index(symbol) for symbol in context.absent_symbols]] = 0.0
    _count_what_matters(context, reach, votes)
    beliefs: Array = votes / votes.sum(axis=1, keepdims=True)
    return beliefs


def prior_beliefs(context: TurnContext) -> Array:
    """Return the (|X|, |Y| + 1) beliefs where no label is near: none as in `class_shares`, the rest by the classifiers.

    If each q_y(x) is the probability that x is of y, apart from the others, then x, known to be of exactly one symbol,
    is of y with a probability proportional to the odds q_y(x) / (1 - q_y(x)).
    """
    odds = context.probabilities / (1 - context.probabilities)
    none = class_shares(context)[-1]
    symbols = (1 - none) * odds / odds.sum(axis=1, keepdims=True)
    return np.column_stack([symbols, np.full(len(odds), none)])


def _count_what_matters(context: TurnContext, reach: float, votes: Array) -> None:
    """Add to (|X|, |Y| + 1) votes what was said of the things that matter; nothing where no symbol is possible."""
    if not context.concepts.judged_views:
        return
    of_symbols = votes[:, :-1].sum(axis=1)
    possible = of_symbols > 0
    nearest = _nearness(context.concepts.distances_to_mattering(context.scene), reach).max(axis=1, initial=0.0)
    votes[possible, :-1] *= (1 + nearest[possible] / of_symbols[possible])[:, None]
    votes[possible & context.concepts.matters(context.scene), -1] = 0.0


def _nearness(distances: Array, reach: float) -> Array:
    return np.asarray(np.exp(-((distances / reach) ** 2) / 2))


def class_shares(context: TurnContext) -> Array:
    """Return (|Y| + 1,) share of the objects of each symbol, or, last, of none, before anything is known of an object.

    The share of none is estimated from the answers to label queries, and from the other things of which it was said
    whether they matter, each counted once, with the prior of Jeffreys. The rest is divided equally, since the symbols
    of the answers depend more on the questions than on the table.
    """
    answers = [r for r in context.history if r.kind is QueryKind.LABEL and r.outcome is Outcome.ANSWERED]
    named = {record.object_id for record in answers}
    judged = {view.object_id: view.matters for view in context.concepts.judged_views if view.object_id not in named}
    of_none = [record.symbol == NO_SYMBOL for record in answers] + [not matters for matters in judged.values()]
    none = (sum(of_none) + 0.5) / (len(of_none) + 1)
    count = len(context.symbols)
    return np.append(np.full(count, (1 - none) / count), none)


def with_labels(context: TurnContext, beliefs: Array) -> Array:
    """Return (|X|, |Y|) beliefs in the symbols, with certainty about the views that have been labelled."""
    known = beliefs[:, :-1].copy()
    for row, label in enumerate(context.concepts.labels_of(context.scene)):
        if label is not None:
            known[row] = [float(label == symbol) for symbol in context.symbols]
    return known
