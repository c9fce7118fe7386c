"""What a question is worth: the features of `value_per_cost`, and the value that they add up to.

A question is worth what its answer would gain if it is an example of a symbol, times the chance that it is one; where
the budget is short of the turns it is judged by that value per cost. The features are the logarithms of these factors,
so that a value is a weighted sum of them, and imitation can learn the weights. The derivation is in docs/method.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import VALUE_CONSTANTS, VALUE_FEATURES, Outcome, QueryKind, SettingsError
from al_questioner.questioning.beliefs import class_beliefs, with_labels
from al_questioner.questioning.candidates import BUDGET_ROUNDING
from al_questioner.questioning.strategies.choice import TIE, Choice, choose_best, rows_of
from al_questioner.questioning.turn_context import Situation

Array = NDArray[np.float64]

LEAST = 1e-6
"""Smallest factor, or constant, that is told from 0: the features stay finite."""
LEAST_PRICE = 1e-2
"""Cheapest question, as a share of the dearest: what costs nothing is not worth infinitely much per cost."""

GAIN, CHANCE, PRICE, AHEAD, SILENCE = range(len(VALUE_FEATURES))


@dataclass(frozen=True)
class Constants:
    """What the value of a question depends on otherwise than by a weight.

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
    decline: float = 0.5
    pace: float = 0.5

    def __post_init__(self) -> None:
        for name in VALUE_CONSTANTS:
            value = getattr(self, name)
            if not (np.isfinite(value) and value >= LEAST):
                raise SettingsError(
                    f'strategy value_per_cost: {name} must be a number of {LEAST:g} or more, not {value}'
                )


DEFAULTS = Constants()

BY_DERIVATION: Mapping[str, float] = {'gain': 1.0, 'chance': 1.0, 'price': -1.0, 'ahead': 1e6, 'silence': -10.0}
"""Weights with which the features add up to the logarithm of a value; that of being ahead makes the pace a rule."""


class ValuePerCost:
    """value_per_cost: the question of largest value, or, where the budget is short, of largest value per cost.

    Args:
        weights: by name in `VALUE_FEATURES` the weights that are not to be those of `BY_DERIVATION`, and by name those
            of the `Constants` that are not to have their default.

    Raises:
        SettingsError: a weight for another feature, or a constant out of its range.
    """

    selector = None

    def __init__(self, weights: Mapping[str, float]) -> None:
        known = (*VALUE_FEATURES, *VALUE_CONSTANTS)
        for name, weight in weights.items():
            if name not in known and weight != 0:
                raise SettingsError(f'strategy value_per_cost does not use {name!r}; it uses {", ".join(known)}')
        self.weights = np.array([float(weights.get(name, BY_DERIVATION[name])) for name in VALUE_FEATURES])
        self.constants = Constants(**{name: float(weights[name]) for name in VALUE_CONSTANTS if name in weights})

    def choose(self, situation: Situation, rng: np.random.Generator) -> Choice:
        """The best of the candidates that are worth anything; the utility is the logarithm of the value."""
        features = value_features(situation, self.constants)
        return choose_best(situation, np.where(is_worthless(features), np.nan, features @ self.weights), rng)


def value_features(situation: Situation, constants: Constants = DEFAULTS) -> Array:
    """(C, 5) of each candidate, in the order of `VALUE_FEATURES`; all finite.

    They are the logarithms of the gain, the chance and the price, and, of asking nothing, how far the spending is ahead
    of its pace, and 1.
    """
    factors = np.ones((len(situation.candidates), 2))
    beliefs = class_beliefs(situation, constants.reach, constants.doubt)
    gains = example_gains(situation, constants.decline)
    labels, demonstrations = rows_of(situation, QueryKind.LABEL), rows_of(situation, QueryKind.DEMONSTRATION)
    if len(labels):
        symbols = beliefs[:, :-1]
        named = symbols.sum(axis=1)
        factors[labels, GAIN] = (symbols * gains).sum(axis=1) / np.maximum(named, LEAST)
        factors[labels, CHANCE] = named * _answered(situation, QueryKind.LABEL)
    if len(demonstrations):
        shown = with_labels(situation, beliefs)
        factors[demonstrations, GAIN] = (shown * gains).sum(axis=0) / np.maximum(shown.sum(axis=0), LEAST)
        here = 1 - np.prod(1 - shown, axis=0)
        factors[demonstrations, CHANCE] = here * _answered(situation, QueryKind.DEMONSTRATION)
    subset = rows_of(situation, QueryKind.FEATURE_SUBSET)
    factors[subset, GAIN], factors[subset, CHANCE] = (
        later_answers(situation),
        _answered(situation, QueryKind.FEATURE_SUBSET),
    )
    asks = np.array([action.kind is not QueryKind.NO_QUERY for action in situation.candidates])
    features = np.zeros((len(factors), len(VALUE_FEATURES)))
    features[:, :2] = np.log(np.maximum(factors, LEAST))
    features[asks, PRICE] = log_prices(situation)[asks]
    features[~asks, AHEAD] = lead(situation, constants.pace)
    features[~asks, SILENCE] = 1.0
    return features


def is_worthless(features: Array) -> NDArray[np.bool_]:
    """(C,) whether candidates with these features, (C, 5), would gain nothing."""
    return np.asarray(features[:, GAIN] <= np.log(LEAST))


def example_gains(situation: Situation, decline: float) -> Array:
    """(|X|, |Y|) what an object would gain as an example of a symbol, as a share of the first example's gain.

    That is nothing where the classifiers call it so already, and where its view is labelled; else (1 + n)^-decline
    beside n examples of the symbol. Among symbols that are equally probable each is called with an equal share.
    """
    mistaken = 1 - called_shares(situation.probabilities)
    mistaken[situation.labelled] = 0.0
    n = np.array(list(situation.knowledge.positives.values()), dtype=np.float64)
    gains: Array = mistaken * (1 + n) ** -decline
    return gains


def called_shares(probabilities: Array) -> Array:
    """(n, |Y|) 1 for the symbol that the classifiers call a thing, 0 for others; of a tie, equal shares.

    Args:
        probabilities: (n, |Y|) q_y(x).
    """
    best = probabilities.max(axis=1, keepdims=True)
    largest = probabilities >= best - TIE * best
    return np.asarray(largest / largest.sum(axis=1, keepdims=True))


def later_answers(situation: Situation) -> float:
    """Labels that can still be asked for once the relevant features are known: each of them gains the more for it."""
    costs = situation.costs
    if costs.label == 0:
        return float(situation.turns_left)
    affordable = np.floor((situation.budget_left - costs.feature_subset + BUDGET_ROUNDING) / costs.label)
    return float(np.clip(affordable, 0, situation.turns_left))


def scarcity(situation: Situation) -> float:
    """How much the budget, rather than the time, limits what can be asked.

    1 if it pays for no more than the cheaper of label and demonstration in each turn that is left, 0 if it pays for the
    dearer, and in proportion between.
    """
    cheap, dear = sorted((situation.costs.label, situation.costs.demonstration))
    turns = situation.turns_left + 1
    if situation.budget_left + BUDGET_ROUNDING >= dear * turns:
        return 0.0
    if situation.budget_left <= cheap * turns:
        return 1.0
    return float((dear * turns - situation.budget_left) / ((dear - cheap) * turns))


def log_prices(situation: Situation) -> Array:
    """(C,) logarithm of what each candidate costs, as a share of the dearest, as far as the budget is short."""
    costs = np.array([situation.costs.of(action.kind) for action in situation.candidates])
    dearest = max(situation.costs.label, situation.costs.demonstration, situation.costs.feature_subset)
    if dearest == 0:
        return np.zeros(len(costs))
    return scarcity(situation) * np.log(np.maximum(costs / dearest, LEAST_PRICE))


def lead(situation: Situation, pace: float) -> float:
    """Share of the budget by which more is spent than later scenes can spare; 0 where the budget is not short.

    It is negative where less is spent.
    """
    if scarcity(situation) == 0 or situation.budget == 0:
        return 0.0
    return situation.spent / situation.budget - float((situation.turn / situation.turns) ** pace)


def _answered(situation: Situation, kind: QueryKind) -> float:
    """Share of the queries of a kind so far that the teacher had an answer to.

    Two answers are imagined before the first: a single failure does not condemn a question. Where nobody was there to
    answer, nothing is said of the question.
    """
    asked = [r.outcome for r in situation.history if r.kind is kind and r.outcome is not Outcome.UNANSWERED]
    return (asked.count(Outcome.ANSWERED) + 2) / (len(asked) + 2)
