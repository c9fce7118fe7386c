"""Registry of the strategies by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import chain

from al_questioner.domain import SettingsError
from al_questioner.questioning.strategies.choice import Strategy, StrategyFactory, weight_names
from al_questioner.questioning.strategies.dt_iros import DtIros
from al_questioner.questioning.strategies.dt_task import DtTask
from al_questioner.questioning.strategies.dt_task_env import DtTaskEnv
from al_questioner.questioning.strategies.expert import ScriptedExpert
from al_questioner.questioning.strategies.farthest import Farthest
from al_questioner.questioning.strategies.human import Human, Picker
from al_questioner.questioning.strategies.names import contribution
from al_questioner.questioning.strategies.plug_ins import ContributedFactory
from al_questioner.questioning.strategies.probcover import ProbCover
from al_questioner.questioning.strategies.random_label import RandomLabel
from al_questioner.questioning.strategies.rarest_demonstration import RarestDemonstration
from al_questioner.questioning.strategies.typiclust import TypiClust
from al_questioner.questioning.strategies.uncertain_unlabelled import UncertainUnlabelled
from al_questioner.questioning.strategies.uncertainty_sampling import UncertaintySampling
from al_questioner.questioning.strategies.value_per_cost import ValuePerCost


def _unweighted(strategy: Callable[[], Strategy]) -> StrategyFactory:
    """Make a factory that leaves the weights aside: they are for the strategies that use them."""
    return lambda weights: strategy()


def _refuse_human(weights: Mapping[str, float]) -> Strategy:
    raise SettingsError('strategy human: nobody is there to choose; give make_strategy a function that asks a person')


STRATEGIES: Mapping[str, StrategyFactory] = {
    'u_sampling': _unweighted(UncertaintySampling),
    'dt_iros': DtIros,
    'dt_task': DtTask,
    'dt_task_env': DtTaskEnv,
    'value_per_cost': ValuePerCost,
    'u_sampling_fsq': _unweighted(UncertainUnlabelled),
    'random_fsq': _unweighted(RandomLabel),
    'farthest_fsq': _unweighted(Farthest),
    'rarest_demo': _unweighted(RarestDemonstration),
    'typiclust': _unweighted(TypiClust),
    'probcover': _unweighted(ProbCover),
    'expert': _unweighted(ScriptedExpert),
    'human': _refuse_human,
}
"""Factories of the strategies that ship, by name."""


def make_strategy(name: str, weights: Mapping[str, float], pick: Picker | None = None) -> Strategy:
    """Make the strategy of this name; other packages are searched only for a name that is not in `STRATEGIES`.

    A strategy that declares weights and constants takes no others, but with weight 0 those that others declare. One
    that ships and declares none leaves them aside. Only the strategy `human` uses `pick`, which asks the person.

    Raises:
        SettingsError: an unknown name, weights that do not fit the strategy, a contributed one that cannot be made, or
            `human` without a function that asks the person.
    """
    factory = STRATEGIES[name] if name in STRATEGIES else ContributedFactory(contribution(name))
    declared = weight_names(factory)
    if declared is not None:
        of_others = set(chain.from_iterable(weight_names(other) or () for other in STRATEGIES.values()))
        for each, weight in weights.items():
            if each not in declared and (weight != 0 or each not in of_others):
                raise SettingsError(f'strategy {name} does not use {each!r}; it uses {", ".join(declared) or "none"}')
    return Human(pick) if name == 'human' and pick is not None else factory(weights)
