"""A robot that learns what things are by asking about them, and that asks wisely.

The names that most programs need; each is imported when it is asked for.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.concepts import ConceptModels as ConceptModels
    from al_questioner.concepts.concept_classifier import ConceptClassifier as ConceptClassifier
    from al_questioner.domain import Answer as Answer
    from al_questioner.domain import Costs as Costs
    from al_questioner.domain import EpisodeSettings as EpisodeSettings
    from al_questioner.domain import InputError as InputError
    from al_questioner.domain import Outcome as Outcome
    from al_questioner.domain import Query as Query
    from al_questioner.domain import QueryKind as QueryKind
    from al_questioner.domain import Scene as Scene
    from al_questioner.experiments.pool_comparison import PoolComparison as PoolComparison
    from al_questioner.experiments.pool_comparison import compare as compare
    from al_questioner.messages.concepts_file import read_concepts as read_concepts
    from al_questioner.messages.concepts_file import write_concepts as write_concepts
    from al_questioner.questioning import Episode as Episode
    from al_questioner.questioning import load_weights as load_weights
    from al_questioner.questioning import make_strategy as make_strategy
    from al_questioner.simulation import Pool as Pool
    from al_questioner.simulation import load_task as load_task
    from al_questioner.simulation import run_episode as run_episode

__version__ = '0.1.0'

__all__, __getattr__ = lazy_names(
    __name__,
    {
        'concepts': ['ConceptModels'],
        'concepts.concept_classifier': ['ConceptClassifier'],
        'domain': ['Answer', 'Costs', 'EpisodeSettings', 'InputError', 'Outcome', 'Query', 'QueryKind', 'Scene'],
        'experiments.pool_comparison': ['PoolComparison', 'compare'],
        'messages.concepts_file': ['read_concepts', 'write_concepts'],
        'questioning': ['Episode', 'load_weights', 'make_strategy'],
        'simulation': ['Pool', 'load_task', 'run_episode'],
    },
)
# It needs scikit-learn, which `import *` must do without.
__all__.remove('ConceptClassifier')


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__, 'ConceptClassifier'})
