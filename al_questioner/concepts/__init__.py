"""Concepts of the learner: one Gaussian process classifier per symbol, and all labels that teachers have given."""

from al_questioner.concepts.concept_learner import ConceptLearner
from al_questioner.concepts.concept_models import ConceptModels, compile_models
from al_questioner.concepts.feature_selection import Selector, rank_p_values, select_features
from al_questioner.concepts.feature_space import VIEW_TOLERANCE
from al_questioner.concepts.kernel import Kernel
from al_questioner.concepts.standardiser import Standardiser
from al_questioner.concepts.view_memory import ViewMemory

__all__ = [
    'VIEW_TOLERANCE',
    'ConceptLearner',
    'ConceptModels',
    'Kernel',
    'Selector',
    'Standardiser',
    'ViewMemory',
    'compile_models',
    'rank_p_values',
    'select_features',
]
