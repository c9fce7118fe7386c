"""The questioning strategies of the paper, and how every strategy is found by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import VIEW_TOLERANCE, Knowledge, Selector, select_features
from al_questioner.domain import DECISION_FEATURES, EpisodeSettings, QueryKind, SettingsError
from al_questioner.questioning.strategies.choice import (
    Choice,
    Strategy,
    StrategyFactory,
    choose_best,
    nothing_considered,
)
from al_questioner.questioning.strategies.controls import (
    Farthest,
    RandomLabel,
    RarestDemonstration,
    UncertainUnlabelled,
)
from al_questioner.questioning.strategies.decision_features import prediction_entropy
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.strategies.expert import ScriptedExpert
from al_questioner.questioning.strategies.human import Human
from al_questioner.questioning.strategies.names import contribution, contributions
from al_questioner.questioning.strategies.plug_ins import contributed_factory
from al_questioner.questioning.strategies.value_per_cost import ValuePerCost
from al_questioner.questioning.turn_context import Situation

IROS_FEATURES = DECISION_FEATURES[:2]
TASK_FEATURES = DECISION_FEATURES[:4]


class UncertaintySampling:
    """U-sampling: label the object of largest prediction entropy, every turn until the budget is gone.

    As in the paper it has no feature subset query, so features are selected computationally. How, and whether it may
    ask again, the paper leaves open.

    Args:
        selector: of the features; None for none.
        repeats: whether it may ask about a view that has been labelled.
    """

    def __init__(self, selector: Selector | None = select_features, repeats: bool = True) -> None:
        self.selector = selector
        self._repeats = repeats

    def choose(self, situation: Situation, rng: np.random.Generator) -> Choice:
        """The affordable label query of largest entropy; nothing if there is none."""
        utilities = nothing_considered(situation)
        entropy = prediction_entropy(situation.probabilities)
        for row, action in enumerate(situation.candidates):
            if action.kind is QueryKind.LABEL and action.object_id is not None:
                index = situation.scene.index_of(action.object_id)
                if self._repeats or not situation.labelled[index]:
                    utilities[row] = entropy[index]
        return choose_best(situation, utilities, rng)


class DecisionTheoretic:
    """The candidate of largest expected utility w . E[phi | a] (equations 1 and 2 of the paper)."""

    selector = None

    def __init__(self, weights: NDArray[np.float64]) -> None:
        self.weights = weights

    def choose(self, situation: Situation, rng: np.random.Generator) -> Choice:
        """The best of all candidates; the choice carries their expected features."""
        features = expected_features(situation)
        return choose_best(situation, features @ self.weights, rng, features)


def decision_theoretic(name: str, used: tuple[str, ...], weights: Mapping[str, float]) -> DecisionTheoretic:
    """A decision-theoretic strategy from weights by decision feature; a feature without a weight has weight 0.

    Raises:
        SettingsError: no weights, or a weight for a feature that this strategy does not use.
    """
    if not weights:
        ship = f"EpisodeSettings(..., weights=load_weights('{name}')) has those that ship"
        raise SettingsError(f'strategy {name} needs weights for some of {", ".join(used)}: {ship}')
    for feature, weight in weights.items():
        if feature not in used and weight != 0:
            raise SettingsError(f'strategy {name} does not use {feature!r}; it uses {", ".join(used)}')
    return DecisionTheoretic(np.array([float(weights.get(feature, 0.0)) for feature in DECISION_FEATURES]))


def _unweighted(strategy: Callable[[], Strategy]) -> StrategyFactory:
    """A factory that leaves the weights aside: they are for the strategies that use them."""
    return lambda weights: strategy()


STRATEGIES: Mapping[str, StrategyFactory] = {
    'u_sampling': _unweighted(UncertaintySampling),
    'dt_iros': partial(decision_theoretic, 'dt_iros', IROS_FEATURES),
    'dt_task': partial(decision_theoretic, 'dt_task', TASK_FEATURES),
    'dt_task_env': partial(decision_theoretic, 'dt_task_env', DECISION_FEATURES),
    'value_per_cost': ValuePerCost,
    'u_sampling_fsq': _unweighted(UncertainUnlabelled),
    'random_fsq': _unweighted(RandomLabel),
    'farthest_fsq': _unweighted(Farthest),
    'rarest_demo': _unweighted(RarestDemonstration),
    'expert': _unweighted(ScriptedExpert),
    'human': _unweighted(Human),
}
"""What makes each strategy that ships, by name."""


def known_strategies() -> tuple[str, ...]:
    """The names of all strategies: those of `STRATEGIES`, then those that other installed packages contribute."""
    return (*STRATEGIES, *contributions())


def strategy_factory(name: str) -> StrategyFactory:
    """What makes the strategy of this name; other packages are searched only for a name that is not in `STRATEGIES`.

    Raises:
        SettingsError: an unknown name, or a contributed strategy that cannot be imported.
    """
    if name in STRATEGIES:
        return STRATEGIES[name]
    return contributed_factory(contribution(name))


def make_strategy(name: str, weights: Mapping[str, float]) -> Strategy:
    """The strategy of this name.

    Args:
        name: one of `known_strategies()`.
        weights: by feature; of the strategies that ship only the decision-theoretic ones and value_per_cost use them.

    Raises:
        SettingsError: an unknown name, weights that do not fit the strategy, or a contributed one that cannot be made.
    """
    return strategy_factory(name)(weights)


def new_knowledge(
    settings: EpisodeSettings, view_tolerance: float = VIEW_TOLERANCE, strategy: Strategy | None = None
) -> Knowledge:
    """What a learner with these settings knows before the first turn.

    Args:
        settings: of the episode.
        view_tolerance: see `Knowledge`.
        strategy: who decides, and selects features, in the place of the strategy that the settings name.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """
    if strategy is None:
        strategy = make_strategy(settings.strategy, settings.weights)
    return Knowledge(
        settings.symbols,
        settings.amplitude,
        settings.length_scale,
        strategy.selector,
        view_tolerance,
    )
