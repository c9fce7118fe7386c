"""The strategy `value_per_cost`: the features of a question's value, and the value that they add up to.

A question is worth what its answer would gain if it is an example of a symbol, times the chance that it is one; where
the budget is short of the turns it is judged by that value per cost. The features are the logarithms of these factors,
so that a value is a weighted sum of them, and imitation can learn the weights. The derivation is in
docs/explanation/value_per_cost.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import NO_SYMBOL, Outcome, QueryKind, SettingsError
from al_questioner.questioning.beliefs import class_beliefs, with_labels
from al_questioner.questioning.candidates import BUDGET_ROUNDING
from al_questioner.questioning.strategies.choice import TIE, Choice, choose_best, rows_of
from al_questioner.questioning.turn_context import TurnContext
from al_questioner.support.arrays import Array

LEAST = 1e-6
"""Smallest factor, or constant, that is told from 0: the features stay finite."""
LEAST_PRICE = 1e-2
"""Cheapest question, as a share of the dearest: what costs nothing is not worth infinitely much per cost."""

VALUE_FEATURES = ('gain', 'chance', 'price', 'ahead', 'silence')
"""The features of what a question is worth, in the order of every weight vector of theirs."""
GAIN, CHANCE, PRICE, AHEAD, SILENCE = range(len(VALUE_FEATURES))


@dataclass(frozen=True)
class Constants:
    """Constants of the value of a question, beside its weights.

    Attributes:
        reach: how far a label tells what things are, in standard deviations of a feature, root mean square.
        doubt: votes, of which a label has one, for what no label tells.
        decline: an example beside n others of its symbol gains (1 + n)^-decline of what the first does.
        pace: nothing is asked once more than a share t to this power of a short budget is spent by a share t of the
            turns: 1 spends evenly, towards 0 at once.

    Raises:
        SettingsError: one that is not a finite number, or below `LEAST`.
    """

    reach: float = 0.25
    doubt: float = 0.03
    decline: float = 0.25
    pace: float = 0.5

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if not (np.isfinite(value) and value >= LEAST):
                reason = f'{name} must be a number of {LEAST:g} or more, not {value}'
                raise SettingsError(f'strategy value_per_cost: {reason}')


DEFAULTS = Constants()
CONSTANTS = tuple(vars(DEFAULTS))
"""Constants that a weights file may set beside the weights."""

BY_DERIVATION: Mapping[str, float] = {'gain': 1.0, 'chance': 1.0, 'price': -1.0, 'ahead': 1e6, 'silence': -10.0}
"""Weights with which the features add up to the logarithm of a value; that of being ahead makes the pace a rule."""


class ValuePerCost:
    """value_per_cost: the question of largest value, or, where the budget is short, of largest value per cost.

    Args:
        weights: by name in `VALUE_FEATURES` the weights that are not to be those of `BY_DERIVATION`, and by name those
            of the `Constants` that are not to have their default.

    Raises:
        SettingsError: a constant out of its range.
    """

    selector = None
    weight_names = (*VALUE_FEATURES, *CONSTANTS)

    def __init__(self, weights: Mapping[str, float]) -> None:
        self.weights = np.array([float(weights.get(name, BY_DERIVATION[name])) for name in VALUE_FEATURES])
        self.constants = Constants(**{name: float(weights[name]) for name in CONSTANTS if name in weights})

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Choose the best of the candidates that are worth anything; the utility is the logarithm of the value."""
        features = value_features(context, self.constants)
        return choose_best(context, np.where(is_worthless(features), np.nan, features @ self.weights), rng)


def value_features(context: TurnContext, constants: Constants = DEFAULTS) -> Array:
    """Return the (C, 5) features of the candidates, in the order of `VALUE_FEATURES`; all finite.

    They are the logarithms of the gain, the chance and the price, and, of asking nothing, how far the spending is ahead
    of its pace, and 1.
    """
    factors = np.ones((len(context.candidates), 2))
    beliefs = class_beliefs(context, constants.reach, constants.doubt)
    gains = example_gains(context, constants.decline)
    labels, demonstrations = rows_of(context, QueryKind.LABEL), rows_of(context, QueryKind.DEMONSTRATION)
    if len(labels):
        symbols = beliefs[:, :-1]
        named = symbols.sum(axis=1)
        factors[labels, GAIN] = (symbols * gains).sum(axis=1) / np.maximum(named, LEAST)
        factors[labels, CHANCE] = named * _answered(context, QueryKind.LABEL)
    if len(demonstrations):
        shown = with_labels(context, beliefs)
        factors[demonstrations, GAIN] = (shown * gains).sum(axis=0) / np.maximum(shown.sum(axis=0), LEAST)
        here = 1 - np.prod(1 - shown, axis=0)
        factors[demonstrations, CHANCE] = here * _answered(context, QueryKind.DEMONSTRATION)
    for kind, gain in (
        (QueryKind.FEATURE_SUBSET, later_answers(context, context.costs.feature_subset)),
        (QueryKind.RELEVANCE, relevance_gain(context, beliefs, gains)),
    ):
        rows = rows_of(context, kind)
        factors[rows, GAIN], factors[rows, CHANCE] = gain, _answered(context, kind)
    asks = np.array([action.kind is not QueryKind.NO_QUERY for action in context.candidates])
    features = np.zeros((len(factors), len(VALUE_FEATURES)))
    features[:, :2] = np.log(np.maximum(factors, LEAST))
    features[asks, PRICE] = log_prices(context)[asks]
    features[~asks, AHEAD] = lead(context, constants.pace)
    features[~asks, SILENCE] = 1.0
    return features


def is_worthless(features: Array) -> NDArray[np.bool_]:
    """Return (C,) whether candidates with these features, (C, 5), would gain nothing."""
    return np.asarray(features[:, GAIN] <= np.log(LEAST))


def example_gains(context: TurnContext, decline: float) -> Array:
    """Return the (|X|, |Y|) gains of objects as examples of a symbol, as shares of the first example's gain.

    That is nothing where the classifiers call it so already, and where its view is labelled; else (1 + n)^-decline
    beside n examples of the symbol. Among symbols that are equally probable each is called with an equal share.
    """
    mistaken = 1 - called_shares(context.probabilities)
    mistaken[context.labelled] = 0.0
    n = np.array(list(context.concepts.positives.values()), dtype=np.float64)
    gains: Array = mistaken * (1 + n) ** -decline
    return gains


def called_shares(probabilities: Array) -> Array:
    """Return (n, |Y|) 1 for the symbol that classifiers with (n, |Y|) q_y(x) call a thing, else 0; of a tie, shares."""
    best = probabilities.max(axis=1, keepdims=True)
    largest = probabilities >= best - TIE * best
    return np.asarray(largest / largest.sum(axis=1, keepdims=True))


def later_answers(context: TurnContext, cost: float) -> float:
    """Return how many labels can still be asked for after a question of this cost.

    Once the relevant features are known, each of them gains the more for it.
    """
    if context.costs.label == 0:
        return float(context.turns_left)
    affordable = np.floor((context.budget_left - cost + BUDGET_ROUNDING) / context.costs.label)
    return float(np.clip(affordable, 0, context.turns_left))


def relevance_gain(context: TurnContext, beliefs: Array, gains: Array) -> float:
    """Return how much more the later labels are expected to gain once it is known which things matter.

    Without the answer, the things that are worth most are asked about, and each gains only if it is of some symbol;
    with it, as many things that are. Before anything was found to be of no symbol it is 0: there may be no clutter,
    and a label tells that for less.

    Args:
        context: the turn.
        beliefs: (|X|, |Y| + 1) from `class_beliefs`.
        gains: (|X|, |Y|) from `example_gains`.
    """
    cost, labels = context.costs.relevance, [view.label for view in context.concepts.labelled_views]
    if cost is None or NO_SYMBOL not in labels:
        return 0.0
    symbols = beliefs[~context.labelled, :-1]
    worth = (symbols * gains[~context.labelled]).sum(axis=1) * _answered(context, QueryKind.LABEL)
    named = symbols.sum()
    count = int(min(later_answers(context, cost), round(named)))
    if count == 0:
        return 0.0
    return float(max(0.0, count * worth.sum() / named - np.sort(worth)[-count:].sum()))


def scarcity(context: TurnContext) -> float:
    """Return how much the budget, rather than the time, limits what can be asked.

    1 if it pays for no more than the cheaper of label and demonstration in each turn that is left, 0 if it pays for the
    dearer, and in proportion between.
    """
    cheap, dear = sorted((context.costs.label, context.costs.demonstration))
    turns = context.turns_left + 1
    if context.budget_left + BUDGET_ROUNDING >= dear * turns:
        return 0.0
    if context.budget_left <= cheap * turns:
        return 1.0
    return float((dear * turns - context.budget_left) / ((dear - cheap) * turns))


def log_prices(context: TurnContext) -> Array:
    """Return the (C,) logarithms of the prices, as shares of the largest, as far as the budget is short."""
    costs = np.array([context.costs.price(action.kind) for action in context.candidates])
    asked = (kind for kind in QueryKind if kind is not QueryKind.NO_QUERY)
    dearest = max(price for kind in asked if np.isfinite(price := context.costs.price(kind)))
    if dearest == 0:
        return np.zeros(len(costs))
    return scarcity(context) * np.log(np.maximum(costs / dearest, LEAST_PRICE))


def lead(context: TurnContext, pace: float) -> float:
    """Share of the budget by which more is spent than later scenes can spare; 0 where the budget is not short.

    It is negative where less is spent.
    """
    if scarcity(context) == 0 or context.budget == 0:
        return 0.0
    return context.spent / context.budget - float((context.turn / context.turns) ** pace)


def _answered(context: TurnContext, kind: QueryKind) -> float:
    """Share of the queries of a kind so far that the teacher had an answer to.

    Two answers are imagined before the first: a single failure does not condemn a question. Where nobody was there to
    answer, nothing is said of the question.
    """
    asked = [r.outcome for r in context.history if r.kind is kind and r.outcome is not Outcome.UNANSWERED]
    return (asked.count(Outcome.ANSWERED) + 2) / (len(asked) + 2)
