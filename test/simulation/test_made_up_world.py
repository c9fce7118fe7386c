"""A table of made-up features, for a task whose things nobody can simulate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from al_questioner.simulation import PerceivedWorld, Task, WorldSpec, episode_settings, load_task, run_episode
from al_questioner.simulation.made_up_world import MadeUpWorld, made_up_scene
from shared.lunches import teacher_of


def made_up(task: Task, seed: int = 1) -> PerceivedWorld:
    return PerceivedWorld(MadeUpWorld(task, seed, seed), made_up_scene)


def workshop(task: Task) -> Task:
    """The task with symbols that no catalogue holds."""
    scenes = replace(task.scenes, class_frequencies={})
    return replace(task, symbols=('screwdriver', 'hammer', 'wrench'), scenes=scenes)


@pytest.mark.parametrize('name', ['prepare_lunch', 'pack_lunchbox', 'kitchen_table', 'mixed_kitchens', 'uw_lunchbox'])
def test_any_task_is_learnt_from_made_up_features(name: str) -> None:
    """Otherwise the dry run would show nothing of how the questions help."""
    task = workshop(load_task(name)).of_sample(1)
    world = made_up(task)
    settings = episode_settings(task, 'farthest_fsq', budget=25, turns=40)
    result = run_episode(WorldSpec(task, 1, 1), settings, teacher_of(task, 1), world=world)
    assert result.final_accuracy > 0.6
    assert result.queries[0].groups == task.relevant_groups
    assert len(world.scene(1)) == task.scenes.objects
    assert set(world.truth(1).values()) <= {*task.symbols, 'none'}
    assert world.change_turns(40)[0] == 1 + task.scenes.change_interval


def test_a_task_without_groups_gets_some(kitchen: Task) -> None:
    """Otherwise a task that names none could not be tried."""
    world = MadeUpWorld(replace(kitchen, relevant_groups=()), 1, 1)
    assert world.relevant_groups == ('colour', 'size')
    scene = made_up_scene(world.scene(1))
    assert {name.split('_')[0] for name in scene.feature_names} == {'colour', 'size', 'noise'}
    noisy = MadeUpWorld(replace(kitchen, relevant_groups=('noise',)), 1, 1)
    assert {name.split('_')[0] for name in noisy.scene(1)[0].sensors} == {'noise', 'other'}


@pytest.mark.parametrize(
    ('groups', 'said'), [(('color',), 'color matters,'), (('color', 'size'), 'color, size matter,')]
)
def test_what_was_made_up_is_told_in_english(kitchen: Task, groups: tuple[str, ...], said: str) -> None:
    """Otherwise it would say that color matter."""
    world = MadeUpWorld(replace(kitchen, relevant_groups=groups), 1, 1)
    assert world.report() == f'dry run on made-up features: {said} noise does not'


def test_the_same_seed_makes_up_the_same(kitchen: Task) -> None:
    """Otherwise nobody could compare two strategies in a dry run."""
    one, again, other = made_up(kitchen), made_up(kitchen), made_up(kitchen, 2)
    assert one.scene(6).equals(again.scene(6))
    assert not one.scene(6).equals(other.scene(6))
    np.testing.assert_array_equal(one.test_set[0], again.test_set[0])
