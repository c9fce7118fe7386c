"""The concept learner at the beginning of an episode."""

from __future__ import annotations

from al_questioner.concepts import VIEW_TOLERANCE, ConceptLearner, Selector
from al_questioner.concepts.kernel import KERNEL_SHAPES
from al_questioner.domain import EpisodeSettings


def new_concept_learner(
    settings: EpisodeSettings, selector: Selector | None, view_tolerance: float = VIEW_TOLERANCE
) -> ConceptLearner:
    """Make the concept learner of these settings and the strategy's selector, as it is before the first turn."""
    return ConceptLearner(
        settings.symbols,
        settings.amplitude,
        settings.length_scale,
        selector,
        view_tolerance,
        KERNEL_SHAPES[settings.kernel_shape],
        settings.class_balance,
    )
