"""How every strategy is found by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial

from al_questioner.domain import DECISION_FEATURES
from al_questioner.questioning.strategies.choice import Strategy, StrategyFactory
from al_questioner.questioning.strategies.decision_theoretic import IROS_FEATURES, TASK_FEATURES, decision_theoretic
from al_questioner.questioning.strategies.expert import ScriptedExpert
from al_questioner.questioning.strategies.farthest import Farthest
from al_questioner.questioning.strategies.human import Human, Picker
from al_questioner.questioning.strategies.names import contribution, contributions
from al_questioner.questioning.strategies.plug_ins import contributed_factory
from al_questioner.questioning.strategies.random_label import RandomLabel
from al_questioner.questioning.strategies.rarest_demonstration import RarestDemonstration
from al_questioner.questioning.strategies.uncertain_unlabelled import UncertainUnlabelled
from al_questioner.questioning.strategies.uncertainty_sampling import UncertaintySampling
from al_questioner.questioning.strategies.value_per_cost import ValuePerCost


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


def make_strategy(name: str, weights: Mapping[str, float], pick: Picker | None = None) -> Strategy:
    """Make the strategy of this name.

    Args:
        name: one of `known_strategies()`.
        weights: by feature; of the strategies that ship only the decision-theoretic ones and value_per_cost use them.
        pick: the person's choices, of the strategy `human`; if not given, it asks at the terminal.

    Raises:
        SettingsError: an unknown name, weights that do not fit the strategy, or a contributed one that cannot be made.
    """
    return Human(pick) if name == 'human' else strategy_factory(name)(weights)
