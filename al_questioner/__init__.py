"""A robot that learns what things are by asking about them, and that asks wisely.

The names that most programs need; each is imported when it is asked for.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.concepts import ConceptModels
    from al_questioner.domain import Answer, Costs, EpisodeSettings, InputError, Outcome, Query, QueryKind, Scene
    from al_questioner.questioning import Episode, load_weights, make_strategy
    from al_questioner.simulation import load_task, run_episode

__version__ = '0.1.0'

__all__ = [
    'Answer',
    'ConceptModels',
    'Costs',
    'Episode',
    'EpisodeSettings',
    'InputError',
    'Outcome',
    'Query',
    'QueryKind',
    'Scene',
    'load_task',
    'load_weights',
    'make_strategy',
    'run_episode',
]

_HOMES = {
    'Answer': 'domain',
    'Costs': 'domain',
    'EpisodeSettings': 'domain',
    'InputError': 'domain',
    'Outcome': 'domain',
    'Query': 'domain',
    'QueryKind': 'domain',
    'Scene': 'domain',
    'ConceptModels': 'concepts',
    'Episode': 'questioning',
    'load_weights': 'questioning',
    'make_strategy': 'questioning',
    'load_task': 'simulation',
    'run_episode': 'simulation',
}

__getattr__ = lazy_names(__name__, _HOMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
