"""Query that a decision-theoretic learner would choose, given a look-ahead."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from look_ahead_parts.states import State

from al_questioner.domain import DECISION_FEATURES
from al_questioner.questioning.strategies import decision_features as phi
from al_questioner.questioning.strategies.expected_utility import task_features
from al_questioner.questioning.strategies.weights import read_weights
from al_questioner.support.arrays import Array
from al_questioner.support.configuration import config_dir

STRATEGY = 'dt_task'


@dataclass(frozen=True)
class Chosen:
    """The query of largest expected utility.

    Attributes:
        action: index into label queries about each thing, then demonstration queries of each symbol.
        margin: by how much its expected utility exceeds the next.
    """

    action: int
    margin: float


def task_weights() -> Array:
    """(4,) shipped weights of the decision features that a look-ahead changes."""
    values = read_weights(config_dir() / 'weights' / f'{STRATEGY}.yaml').values
    return np.array([values.get(name, 0.0) for name in DECISION_FEATURES[:4]])


def choose(state: State, q: Array, ahead: Array, weights: Array) -> Chosen:
    """Choose a query as a learner would.

    Args:
        state: examples and scene.
        q: (|X|, |Y|) present beliefs.
        ahead: (|X|, |Y|, |X|, |Y|) look-ahead.
        weights: (4,) from `task_weights`.
    """
    utility = utilities(state, ahead, weights)
    of_labels = (phi.symbol_given_object(q) * utility).sum(axis=1)
    of_demonstrations = (phi.object_given_symbol(q) * utility).sum(axis=0)
    expected = np.concatenate([of_labels, of_demonstrations])
    second, best = np.partition(expected, -2)[-2:]
    return Chosen(int(np.argmax(expected)), float(best - second))


def utilities(state: State, ahead: Array, weights: Array) -> Array:
    """(e, |Y|) utility of the state after each hypothesis of a part of the look-ahead, (e, |Y|, |X|, |Y|)."""
    counts = state.positives + np.eye(len(state.symbols))
    utility: Array = task_features(ahead, counts) @ weights
    return utility
