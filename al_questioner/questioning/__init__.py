"""What to ask next: candidate queries, their expected utility, strategies, and the ask/tell episode."""

from al_questioner.questioning.choice import Choice, Strategy
from al_questioner.questioning.controls import UnlabelledFirst
from al_questioner.questioning.episode import Episode, new_knowledge
from al_questioner.questioning.situation import Situation
from al_questioner.questioning.strategies import (
    IROS_FEATURES,
    STRATEGIES,
    TASK_FEATURES,
    UncertaintySampling,
    make_strategy,
)
from al_questioner.questioning.weights import Weights, read_weights

__all__ = [
    'IROS_FEATURES',
    'STRATEGIES',
    'TASK_FEATURES',
    'Choice',
    'Episode',
    'Situation',
    'Strategy',
    'UncertaintySampling',
    'UnlabelledFirst',
    'Weights',
    'make_strategy',
    'new_knowledge',
    'read_weights',
]
