"""Basic types of the package: scenes, queries, answers, settings, and the errors that they raise.

All are plain frozen dataclasses. Nothing here knows how a value is computed, drawn, sent or stored.
"""

from __future__ import annotations

from al_questioner.domain.errors import AnswerError, EpisodeError, InputError, SceneError, SettingsError
from al_questioner.domain.query import (
    DECISION_FEATURES,
    NO_SYMBOL,
    SAYABLE_OUTCOMES,
    Action,
    Answer,
    Content,
    Decision,
    Outcome,
    Query,
    QueryKind,
    QueryRecord,
)
from al_questioner.domain.random_streams import random_stream
from al_questioner.domain.scene import Camera, FloatArray, Observation, Scene, View, group_of
from al_questioner.domain.setting import Setting
from al_questioner.domain.settings import (
    AMPLITUDE,
    AUTO,
    BUDGET,
    CHANGE_INTERVAL,
    CLASS_BALANCE,
    CLASSIFIERS,
    COST_RELEVANCE,
    COSTS,
    DEFAULT_CLASSIFIERS,
    KERNEL_SHAPE,
    LARGEST_TURN,
    LENGTH_SCALE,
    NEVER,
    SAME_VIEW,
    TURNS,
    Classifiers,
    Costs,
    EpisodeSettings,
    ViewTolerance,
    price_of,
)

__all__ = [
    'AMPLITUDE',
    'AUTO',
    'BUDGET',
    'CHANGE_INTERVAL',
    'CLASSIFIERS',
    'CLASS_BALANCE',
    'COSTS',
    'COST_RELEVANCE',
    'DECISION_FEATURES',
    'DEFAULT_CLASSIFIERS',
    'KERNEL_SHAPE',
    'LARGEST_TURN',
    'LENGTH_SCALE',
    'NEVER',
    'NO_SYMBOL',
    'SAME_VIEW',
    'SAYABLE_OUTCOMES',
    'TURNS',
    'Action',
    'Answer',
    'AnswerError',
    'Camera',
    'Classifiers',
    'Content',
    'Costs',
    'Decision',
    'EpisodeError',
    'EpisodeSettings',
    'FloatArray',
    'InputError',
    'Observation',
    'Outcome',
    'Query',
    'QueryKind',
    'QueryRecord',
    'Scene',
    'SceneError',
    'Setting',
    'SettingsError',
    'View',
    'ViewTolerance',
    'group_of',
    'price_of',
    'random_stream',
]
