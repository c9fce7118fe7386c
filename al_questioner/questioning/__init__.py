"""What to ask next: candidate queries, their expected utility, strategies, and the ask/tell episode."""

from al_questioner.questioning.choice import Choice, Strategy, choose_best, has_asked, nothing_considered, rows_of
from al_questioner.questioning.controls import UnlabelledFirst
from al_questioner.questioning.decision_features import symbol_given_object
from al_questioner.questioning.episode import Episode
from al_questioner.questioning.expected_utility import expected_features
from al_questioner.questioning.feature_sets import FEATURE_SETS, FeatureSet, Observed
from al_questioner.questioning.human import Human, Remembered
from al_questioner.questioning.situation import Situation
from al_questioner.questioning.strategies import (
    IROS_FEATURES,
    STRATEGIES,
    TASK_FEATURES,
    UncertaintySampling,
    known_strategies,
    make_strategy,
    new_knowledge,
    strategy_factory,
)
from al_questioner.questioning.weights import Weights, load_weights, read_weights, shipped_file

__all__ = [
    'FEATURE_SETS',
    'IROS_FEATURES',
    'STRATEGIES',
    'TASK_FEATURES',
    'Choice',
    'Episode',
    'FeatureSet',
    'Human',
    'Observed',
    'Remembered',
    'Situation',
    'Strategy',
    'UncertaintySampling',
    'UnlabelledFirst',
    'Weights',
    'choose_best',
    'expected_features',
    'has_asked',
    'known_strategies',
    'load_weights',
    'make_strategy',
    'new_knowledge',
    'nothing_considered',
    'read_weights',
    'rows_of',
    'shipped_file',
    'strategy_factory',
    'symbol_given_object',
]
