"""The words that every part of the package uses.

Plain frozen dataclasses and the errors they raise. Nothing here knows how a thing is computed, drawn, sent or stored.
"""

from __future__ import annotations

from al_questioner.domain.errors import (
    AnswerError,
    EpisodeError,
    InputError,
    SceneError,
    SettingsError,
)
from al_questioner.domain.query import (
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
from al_questioner.domain.settings import (
    AMPLITUDE,
    AMPLITUDE_RANGE,
    AUTO,
    DECISION_FEATURES,
    LARGEST_AMOUNT,
    LENGTH_SCALE_RANGE,
    VALUE_CONSTANTS,
    VALUE_FEATURES,
    WEIGHED,
    Costs,
    EpisodeSettings,
    ViewTolerance,
)

__all__ = [
    'AMPLITUDE',
    'AMPLITUDE_RANGE',
    'AUTO',
    'DECISION_FEATURES',
    'LARGEST_AMOUNT',
    'LENGTH_SCALE_RANGE',
    'NO_SYMBOL',
    'SAYABLE_OUTCOMES',
    'VALUE_CONSTANTS',
    'VALUE_FEATURES',
    'WEIGHED',
    'Action',
    'Answer',
    'AnswerError',
    'Camera',
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
    'SettingsError',
    'View',
    'ViewTolerance',
    'group_of',
    'random_stream',
]
