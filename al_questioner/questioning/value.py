"""What a question is worth: the features of `value_per_cost`, and the value that they add up to.

A question is worth the expected novelty of the view that it names, times how much a label of that view is needed, times
the chance of an answer, and where the budget is short of the turns it is judged by that value per cost. The features
are the logarithms of these factors, so that a value is a weighted sum of them, and imitation can learn the weights. The
derivation is in docs/method.md.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import NO_SYMBOL, VALUE_FEATURES, Outcome, QueryKind, SettingsError
from al_questioner.questioning.candidates import BUDGET_ROUNDING
from al_questioner.questioning.choice import Choice, choose_best, rows_of
from al_questioner.questioning.situation import Situation

Array = NDArray[np.float64]

REACH = 0.6
"""How far a label tells what things are, in standard deviations of a feature, root mean square over the features."""
NONE_NEED = 0.03
"""What hearing that a thing belongs to no symbol is worth, as a share of an example of the symbol needed most."""
FRONT_LOADING = 0.5
"""Nothing is asked once more than a share t to this power of the budget is spent by a share t of the turns."""

LEAST = 1e-6
"""Smallest factor that is told from 0: the features stay finite."""
LEAST_COST = 1e-2
"""Cheapest question: what costs nothing is not worth infinitely much per cost."""
CERTAIN = 1e-6
"""A classifier's probability is kept so far from 0 and 1."""

NOVELTY, NEED, CHANCE, PRICE, AHEAD, SILENCE = range(len(VALUE_FEATURES))


class ValuePerCost:
    """value_per_cost: the question of largest value, or, where the budget is short, of largest value per cost.

    Args:
        weights: weight by name in `VALUE_FEATURES`; one that is missing is 0.

    Raises:
        SettingsError: no weights, or one for another feature.
    """

    selector = None

    def __init__(self, weights: Mapping[str, float]) -> None:
        if not weights:
            raise SettingsError(f'strategy value_per_cost needs weights for some of {", ".join(VALUE_FEATURES)}')
        for name, weight in weights.items():
            if name not in VALUE_FEATURES and weight != 0:
                raise SettingsError(
                    f'strategy value_per_cost does not use {name!r}; it uses {", ".join(VALUE_FEATURES)}'
                )
        self.weights = np.array([float(weights.get(name, 0.0)) for name in VALUE_FEATURES])

    def choose(self, situation: Situation, rng: np.random.Generator) -> Choice:
        """The best of the candidates that are worth anything; the utility is the logarithm of the value."""
        features = value_features(situation)
        worthless = (features[:, [NOVELTY, NEED, CHANCE]] <= np.log(LEAST)).any(axis=1)
        return choose_best(situation, np.where(worthless, np.nan, features @ self.weights), rng)


def value_features(situation: Situation) -> Array:
    """(C, 6) logarithms of the factors of each candidate's value, in the order of `VALUE_FEATURES`; all finite."""
    factors = np.ones((len(situation.candidates), 4))
    beliefs, novelty, needs = class_beliefs(situation), novelties(situation), class_needs(situation)
    labels = rows_of(situation, QueryKind.LABEL)
    if len(labels):
        factors[labels, NOVELTY] = novelty
        factors[labels, NEED] = beliefs @ needs
        factors[labels, CHANCE] = _answered(situation, QueryKind.LABEL)
    demonstrations = rows_of(situation, QueryKind.DEMONSTRATION)
    if len(demonstrations):
        known = _with_labels(situation, beliefs)
        factors[demonstrations, NOVELTY] = novelty @ known / np.maximum(known.sum(axis=0), LEAST)
        factors[demonstrations, NEED] = needs[:-1]
        shown = [_answered(situation, QueryKind.DEMONSTRATION, symbol) for symbol in situation.symbols]
        factors[demonstrations, CHANCE] = (1 - np.prod(1 - known, axis=0)) * shown
    factors[rows_of(situation, QueryKind.FEATURE_SUBSET), NEED] = later_answers(situation)
    asks = np.array([action.kind is not QueryKind.NO_QUERY for action in situation.candidates])
    if is_budget_short(situation):
        costs = np.array([situation.costs.of(action.kind) for action in situation.candidates])
        factors[asks, PRICE] = np.maximum(costs, LEAST_COST)[asks]
    features = np.zeros((len(factors), len(VALUE_FEATURES)))
    features[:, :4] = np.log(np.maximum(factors, LEAST))
    features[~asks, AHEAD] = lead(situation)
    features[~asks, SILENCE] = 1.0
    return features


def class_beliefs(situation: Situation) -> Array:
    """(|X|, |Y| + 1) probability that an object is of each symbol, or, last, of none.

    The classifiers are independent of each other, so "of y and of no other" has odds P_y / (1 - P_y) against "of none";
    each is weighted by its share among the label answers so far, with a prior that counts as one answer.
    """
    names = (*situation.symbols, NO_SYMBOL)
    answers = [r.symbol for r in situation.history if r.kind is QueryKind.LABEL and r.outcome is Outcome.ANSWERED]
    shares = np.array([answers.count(name) + 1 / len(names) for name in names]) / (len(answers) + 1)
    q = np.clip(situation.probabilities, CERTAIN, 1 - CERTAIN)
    odds = np.hstack([q / (1 - q), np.ones((len(q), 1))]) * shares
    beliefs: Array = odds / odds.sum(axis=1, keepdims=True)
    return beliefs


def novelties(situation: Situation) -> Array:
    """(|X|,) share of an object's label that its nearest labelled view does not tell; 0 for a labelled view itself."""
    if not situation.knowledge.labelled_views:
        return np.ones(len(situation.scene))
    distance = situation.knowledge.distance_to_labelled(situation.scene)
    return np.where(situation.labelled, 0.0, -np.expm1(-(distance**2) / (2 * REACH**2)))


def class_needs(situation: Situation) -> Array:
    """(|Y| + 1,) what an example of each symbol, or, last, of none, is worth.

    If n examples leave an error of 2 / (1 + n), one more saves 2 / (1 + n) - 2 / (2 + n): the first saves 1.
    """
    n = np.array(list(situation.knowledge.positives.values()), dtype=np.float64)
    needs = 2 / ((1 + n) * (2 + n))
    return np.append(needs, NONE_NEED * needs.max())


def later_answers(situation: Situation) -> float:
    """Labels that can still be asked for once the relevant features are known: each of them tells the more for it."""
    costs = situation.costs
    affordable = float(situation.turns_left)
    if costs.label > 0:
        affordable = np.floor((situation.budget_left - costs.feature_subset + BUDGET_ROUNDING) / costs.label)
    return float(max(0.0, min(situation.turns_left, affordable)))


def is_budget_short(situation: Situation) -> bool:
    """Whether the budget, rather than the time, limits what can be asked: it pays for no label in each turn left."""
    return situation.budget_left + BUDGET_ROUNDING < situation.costs.label * (situation.turns_left + 1)


def lead(situation: Situation) -> float:
    """Share of the budget by which more is spent than later scenes can spare; 0 where the budget is not short.

    It is negative where less is spent.
    """
    if not is_budget_short(situation):
        return 0.0
    due = (situation.turn / situation.turns) ** FRONT_LOADING
    return situation.spent / situation.budget - due if situation.budget > 0 else 0.0


def _answered(situation: Situation, kind: QueryKind, symbol: str | None = None) -> float:
    """Share of the queries of a kind, about a symbol if it is one, that came to something.

    Two successes are imagined before the first: a single failure does not condemn a question. Where nobody was there to
    answer, nothing is said of the question.
    """
    history = [r for r in situation.history if r.outcome is not Outcome.UNANSWERED]
    asked = [r for r in history if r.kind is kind and (symbol is None or r.symbol == symbol)]
    useful = sum(r.outcome is Outcome.ANSWERED and r.object_id is not None for r in asked)
    return (useful + 2) / (len(asked) + 2)


def _with_labels(situation: Situation, beliefs: Array) -> Array:
    """(|X|, |Y|) the beliefs, but certainty about the views that have been labelled: who shows a y may show these."""
    known = beliefs[:, :-1].copy()
    for row, label in enumerate(situation.knowledge.labels_of(situation.scene)):
        if label is not None:
            known[row] = [float(label == symbol) for symbol in situation.symbols]
    return known
