"""The settings of an episode, from the user and from the task."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from al_questioner.domain import SettingsError
from al_questioner.simulation import episode_settings
from shared.lunches import TASK


def test_settings_come_from_the_task_unless_given() -> None:
    """Otherwise an episode would be played with other limits than the task's or the user's."""
    settings = episode_settings(TASK)
    assert (settings.budget, settings.turns) == (TASK.episode.budget, TASK.episode.turns)
    assert settings.change_interval == TASK.scenes.change_interval
    assert episode_settings(TASK, budget=0).budget == 0
    assert set(episode_settings(TASK, 'dt_iros').weights) == {'discriminability', 'class_uniformity'}


def test_a_name_that_the_strategy_does_not_declare_is_refused_with_its_file(tmp_path: Path) -> None:
    """Otherwise a misspelt weight would have no effect, and nobody know where it stands."""
    path = tmp_path / 'mine.yaml'
    path.write_text('weights: {discriminability: 1, class_unifromity: 1}')
    reason = f"{path}: strategy dt_iros does not use 'class_unifromity'; it uses discriminability, class_uniformity"
    with pytest.raises(SettingsError, match=re.escape(reason)):
        episode_settings(TASK, 'dt_iros', weights_file=str(path))


def test_weights_for_a_strategy_without_any_are_refused() -> None:
    """Otherwise a user would believe that the weights had an effect."""
    with pytest.raises(SettingsError, match='uses no weights'):
        episode_settings(TASK, 'random_fsq', weights_file='mine.yaml')
