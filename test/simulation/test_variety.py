"""Tables that differ from sample to sample."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from al_questioner.domain import InputError
from al_questioner.simulation import Interval, PerceivedWorld, Task, WorldSpec, episode_settings, load_task
from shared.task_files import task_content, write_task

KITCHENS = 200
OTHERS = {'change_interval': [4, 20], 'persistence': [0, 1], 'clutter_share': [0, 0.5]}


@pytest.fixture(scope='module')
def mixed() -> Task:
    return load_task('mixed_kitchens')


def test_a_kitchen_follows_from_its_number_alone(mixed: Task) -> None:
    """Otherwise strategies would be compared in different worlds, or a recorded episode could not be played again."""
    one, again, other = mixed.of_sample(7), mixed.of_sample(7), mixed.of_sample(8)
    assert one.scenes == again.scenes
    assert one.scenes != other.scenes
    assert one.of_sample(8) == one, 'it is a kitchen now, and no longer any'
    assert WorldSpec(mixed, seed=3, sample=7).task == one
    assert load_task('kitchen_table').of_sample(7) == load_task('kitchen_table')


def test_kitchens_fill_the_stated_ranges_and_share_the_rest(mixed: Task) -> None:
    variety = mixed.variety
    assert variety is not None
    kitchens = [mixed.of_sample(sample).scenes for sample in range(KITCHENS)]
    for name in ('objects', 'change_interval', 'persistence', 'clutter_share'):
        values, ends = [getattr(kitchen, name) for kitchen in kitchens], getattr(variety, name)
        margin = 0.05 * (ends.high - ends.low)
        assert ends.low <= min(values) <= ends.low + margin, name
        assert ends.high - margin <= max(values) <= ends.high, name
    for kitchen in kitchens:
        assert sum(kitchen.class_frequencies.values()) == pytest.approx(1)
    rarest = [min(kitchen.class_frequencies.values()) for kitchen in kitchens]
    assert 0.05 < np.mean(rarest) < 0.15
    assert {kitchen.training_size for kitchen in kitchens} == {mixed.scenes.training_size}


def test_the_robot_is_told_the_interval_of_its_kitchen(mixed: Task) -> None:
    """Otherwise the paper's strategies, which need it, would be handicapped."""
    small = replace(mixed, scenes=replace(mixed.scenes, training_size=60, test_size=4))
    for sample in range(3):
        world_spec = WorldSpec(small, sample, sample)
        world, interval = PerceivedWorld(world_spec.open()), world_spec.task.scenes.change_interval
        assert episode_settings(world_spec.task).change_interval == interval
        assert world.change_turns(40)[:1] == [1 + interval]
        assert len(world.truth(1)) == world_spec.task.scenes.objects


def test_an_interval_may_be_fixed_for_all_kitchens(mixed: Task) -> None:
    assert mixed.variety is not None
    fixed = replace(mixed, variety=replace(mixed.variety, change_interval=Interval(5, 5)))
    assert {fixed.of_sample(sample).scenes.change_interval for sample in range(20)} == {5}


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'variety': {'objects': [0, 5], **OTHERS}}, r'variety: objects: 0 is outside \[1, 200\]'),
        (
            {'variety': {**OTHERS, 'objects': [1, 5], 'clutter_share': [0.5, 0.2]}},
            'clutter_share: the lowest value 0.5',
        ),
        ({'variety': {'depth': [1, 2]}}, "variety: unknown key 'depth'"),
        ({'variety': {'objects': [1, 30]}}, "variety: key 'change_interval' is missing"),
        ({'scenes': {'turnover': 'state'}}, 'variety: only simulated things that leave'),
        ({'scenes': {'training_size': 20}}, 'training_size is below the number of objects'),
    ],
)
def test_unusable_varieties(tmp_path: Path, changes: dict[str, dict[str, object]], reason: str) -> None:
    content = task_content('mixed_kitchens')
    for section, values in changes.items():
        content[section] = values if section == 'variety' else {**content[section], **values}
    with pytest.raises(InputError, match=reason):
        load_task(write_task(tmp_path, content))
