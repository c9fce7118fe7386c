"""The ask/tell episode, candidates, strategies, and answers in plain words."""

from al_questioner.questioning.answers import PreparedAnswer, Receipt
from al_questioner.questioning.episode import Episode
from al_questioner.questioning.initial_concepts import new_concept_learner
from al_questioner.questioning.plain_answers import read_plain_answer, respelt
from al_questioner.questioning.scene_recogniser import SceneRecogniser
from al_questioner.questioning.strategies.choice import (
    Choice,
    Strategy,
    choose_best,
    has_asked,
    nothing_considered,
    rows_of,
    weight_names,
)
from al_questioner.questioning.strategies.decision_features import symbol_given_object
from al_questioner.questioning.strategies.dt_iros import DtIros
from al_questioner.questioning.strategies.dt_task import DtTask
from al_questioner.questioning.strategies.expected_utility import expected_features
from al_questioner.questioning.strategies.feature_sets import FEATURE_SETS, FeatureRecorder, FeatureSet
from al_questioner.questioning.strategies.human import Human, Picker
from al_questioner.questioning.strategies.registry import STRATEGIES, make_strategy
from al_questioner.questioning.strategies.subset_first import UnlabelledFirst
from al_questioner.questioning.strategies.uncertainty_sampling import UncertaintySampling
from al_questioner.questioning.strategies.weights import Weights, load_weights, read_weights, shipped_file
from al_questioner.questioning.teacher import Teacher
from al_questioner.questioning.turn_context import TurnContext

__all__ = [
    'FEATURE_SETS',
    'STRATEGIES',
    'Choice',
    'DtIros',
    'DtTask',
    'Episode',
    'FeatureRecorder',
    'FeatureSet',
    'Human',
    'Picker',
    'PreparedAnswer',
    'Receipt',
    'SceneRecogniser',
    'Strategy',
    'Teacher',
    'TurnContext',
    'UncertaintySampling',
    'UnlabelledFirst',
    'Weights',
    'choose_best',
    'expected_features',
    'has_asked',
    'load_weights',
    'make_strategy',
    'new_concept_learner',
    'nothing_considered',
    'read_plain_answer',
    'read_weights',
    'respelt',
    'rows_of',
    'shipped_file',
    'symbol_given_object',
    'weight_names',
]
