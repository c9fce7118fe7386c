"""Small worlds, so that the tests render few views."""

from __future__ import annotations

from dataclasses import replace

import pytest

from al_questioner.simulation import Task, load_task


@pytest.fixture(scope='session')
def lunch() -> Task:
    return load_task('prepare_lunch')


@pytest.fixture(scope='session')
def kitchen() -> Task:
    return load_task('kitchen_table')


@pytest.fixture(scope='session')
def lunchbox() -> Task:
    return load_task('pack_lunchbox')


@pytest.fixture(scope='session')
def small(kitchen: Task) -> Task:
    """A kitchen table of six things."""
    scenes = replace(kitchen.scenes, objects=6, training_size=24, test_size=8, clutter_share=0.5)
    return replace(kitchen, scenes=scenes)
