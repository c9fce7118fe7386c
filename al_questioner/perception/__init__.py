"""Measurement of an object in its RGB-D view, as a named feature vector."""

from al_questioner.perception.features import VIEW_FEATURE_NAMES, view_features
from al_questioner.perception.scene import perceive

__all__ = ['VIEW_FEATURE_NAMES', 'perceive', 'view_features']
