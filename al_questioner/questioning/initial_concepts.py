"""The concept learner at the beginning of an episode."""

from __future__ import annotations

from al_questioner.concepts import VIEW_TOLERANCE, ConceptLearner
from al_questioner.domain import EpisodeSettings
from al_questioner.questioning.strategies.choice import Strategy
from al_questioner.questioning.strategies.registry import make_strategy


def new_concept_learner(
    settings: EpisodeSettings, view_tolerance: float = VIEW_TOLERANCE, strategy: Strategy | None = None
) -> ConceptLearner:
    """Make the concept learner of these settings, as it is before the first turn.

    A strategy that is given selects features in the place of the one that the settings name.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """
    if strategy is None:
        strategy = make_strategy(settings.strategy, settings.weights)
    return ConceptLearner(
        settings.symbols, settings.amplitude, settings.length_scale, strategy.selector, view_tolerance
    )
