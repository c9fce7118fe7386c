"""World from arrays."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest

from al_questioner.domain import NO_SYMBOL, Costs, InputError
from al_questioner.experiments.ceilings import CEILING_SETTINGS, CEILINGS
from al_questioner.simulation import Evaluation, Pool, PoolWorld, ScriptedTeacher, episode_settings, run_episode

NAMES = ('size_height', 'size_width', 'colour', 'noise')


def pool_of(things: int = 60, *, clutter: int = 0) -> Pool:
    """Things whose second feature is their number, and whose first one tells their symbol."""
    rng = np.random.default_rng(0)
    features = rng.normal(size=(things, len(NAMES)))
    labels = [('snack', 'fruit', 'drink')[i % 3] for i in range(things)]
    features[:, 0] += [4.0 * (i % 3) for i in range(things)]
    features[:, 1] = np.arange(things)
    labels[:clutter] = [NO_SYMBOL] * clutter
    return Pool(features, labels, NAMES)


def things_in(features: np.ndarray) -> list[int]:
    """Numbers of the things."""
    return features[:, 1].astype(int).tolist()


def test_a_pool_takes_what_users_have() -> None:
    """Lists, and labels that are whole numbers, as data sets have them."""
    pool = Pool([[1, 2], [3, 4], [5, 6]], np.array([0, 1, 10]), ['a_x', 'b_y'])
    assert pool.features.dtype == np.float32
    assert pool.labels == ('0', '1', '10')
    assert pool.symbols == ('0', '1', '10')
    assert pool.groups == ('a', 'b')
    assert len(pool) == 3


def test_the_groups_of_the_features_will_do_for_their_names() -> None:
    """A data set often says no more, and a person is asked about groups alone."""
    pool = Pool(np.ones((2, 4)), ['a', 'b'], ['size', 'colour_hue', 'size', 'noise'])
    assert pool.feature_names == ('size_0', 'colour_hue', 'size_1', 'noise')
    assert pool.groups == ('size', 'colour', 'noise')
    assert Pool(np.ones((2, 2)), ['a', 'b']).groups == ('feature0', 'feature1')


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'features': [[1, 2], [3]]}, 'features must be rows of numbers, all of the same length'),
        ({'features': [1, 2, 3]}, 'features must be a table of things by features, not of shape (3,)'),
        ({'features': [[1, 2], [3, np.nan]]}, 'feature b_y of thing 1 is not finite (nan)'),
        ({'features': [[1, 2], [3, 1e39]]}, 'feature b_y of thing 1 is not finite (inf)'),
        ({'labels': 'ab'}, "labels must be a list of names, not 'ab'"),
        ({'labels': [0.5, 1]}, 'a label must be a name or a whole number, not 0.5'),
        ({'labels': ['a']}, 'there are 2 things, but 1 labels'),
        ({'labels': ['a', NO_SYMBOL]}, "the things must be of at least two symbols, not of ['a']"),
        ({'feature_names': 'ab'}, "feature_names must be a list of names, not 'ab'"),
        ({'feature_names': ['a']}, 'the things have 2 features, but there are 1 feature names'),
        (
            {'features': np.ones((2, 3)), 'feature_names': ['a', 'a', 'a_1']},
            'a feature name occurs twice',
        ),
    ],
)
def test_a_pool_that_cannot_be_used_is_refused(changes: dict[str, object], reason: str) -> None:
    """An error in the arrays would otherwise come up somewhere in the middle of an episode, or not at all."""
    given = {'features': [[1, 2], [3, 4]], 'labels': ['a', 'b'], 'feature_names': ['a_x', 'b_y'], **changes}
    with pytest.raises(InputError, match=f'^{re.escape(reason)}$'):
        Pool(**given)


@pytest.mark.parametrize(
    ('changes', 'reason'),
    [
        ({'split': -1}, 'split must be a whole number of 0 or more, not -1'),
        ({'in_view': 0}, 'in_view must be a whole number of 1 or more, not 0'),
        ({'in_view': 2.5}, 'in_view must be a whole number of 1 or more, not 2.5'),
        ({'split': '0'}, "split must be a whole number of 0 or more, not '0'"),
        ({'change_interval': 0}, 'change_interval must be a whole number of 1 or more, not 0'),
        ({'test_share': 1.0}, 'test_share must be a number between 0 and 1, not 1.0'),
        ({'in_view': 31}, '30 things are not held out, too few for 31 on a table'),
        ({'test_share': 0.001}, 'nothing of a symbol is held out'),
        ({'relevant_groups': ('taste',)}, "unknown feature group 'taste'; known: size, colour, noise"),
        ({'relevant_groups': 'size'}, "unknown feature group 'size'; known: size, colour, noise"),
    ],
)
def test_a_world_that_cannot_be_is_refused(changes: dict[str, object], reason: str) -> None:
    """One line says which number is wrong."""
    with pytest.raises(InputError, match=f'^{re.escape(reason)}$'):
        PoolWorld(pool_of(), **{'split': 0, **changes})


def test_nothing_that_is_held_out_is_ever_shown() -> None:
    """Otherwise accuracy would be measured on what was taught."""
    world = PoolWorld(pool_of(), 4, in_view=10, change_interval=5)
    shown = {thing for turn in range(1, 61) for thing in things_in(world.scene(turn).features)}
    held_out = set(things_in(world.test_set[0]))
    assert len(held_out) == 30
    assert shown == set(range(60)) - held_out


def test_the_scene_changes_wholly_and_in_time() -> None:
    """All things leave, others come with new ids, and none comes back before all others were there."""
    world = PoolWorld(pool_of(), 4, in_view=10, change_interval=5)
    assert world.change_turns(16) == [6, 11, 16]
    assert world.scene(1) is world.scene(5)
    scenes = [world.scene(turn) for turn in (1, 6, 11, 16)]
    things = [things_in(scene.features) for scene in scenes]
    assert sorted([*things[0], *things[1], *things[2]]) == sorted(set(range(60)) - set(things_in(world.test_set[0])))
    assert len({object_id for scene in scenes for object_id in scene.object_ids}) == 40
    assert things[3] != things[0]


def test_the_truth_is_that_of_the_pool() -> None:
    """The teacher must name what is there, clutter too."""
    pool = pool_of(clutter=20)
    world = PoolWorld(pool, 1)
    scene, truth = world.scene(13), world.truth(13)
    assert tuple(truth) == scene.object_ids
    assert [truth[i] for i in scene.object_ids] == [pool.labels[thing] for thing in things_in(scene.features)]
    assert NO_SYMBOL in truth.values()
    features, symbols = world.test_set
    assert NO_SYMBOL not in symbols
    assert symbols == tuple(pool.labels[thing] for thing in things_in(features))


def test_the_split_decides_all() -> None:
    """The same number gives the same world in any order of turns, another number another one."""
    worlds = [PoolWorld(pool_of(), split) for split in (2, 2, 3)]
    backward = {turn: worlds[1].scene(turn) for turn in range(40, 0, -1)}
    assert all(worlds[0].scene(turn).equals(backward[turn]) for turn in range(1, 41))
    assert np.array_equal(worlds[0].test_set[0], worlds[1].test_set[0])
    assert not np.array_equal(worlds[0].test_set[0], worlds[2].test_set[0])
    with pytest.raises(InputError, match='turn must be 1 or more, not 0'):
        worlds[0].scene(0)


def test_an_episode_is_played_as_in_any_world() -> None:
    """Data of all sorts go through the same code as our tables."""
    world = PoolWorld(pool_of(120), 5, relevant_groups=('size',))
    settings = episode_settings(world.task, 'u_sampling_fsq', budget=12, turns=20)
    assert settings.change_interval == 10
    teacher = ScriptedTeacher(world.task.symbols, world.task.relevant_groups, 5)
    result = run_episode(world.spec, settings, teacher, world=world)
    assert result.queries[0].groups == ('size',)
    assert result.test_size == 60
    assert result.final_accuracy > 0.5
    again = run_episode(world.spec, settings, teacher, world=PoolWorld(pool_of(120), 5, relevant_groups=('size',)))
    assert again.queries == result.queries


def test_the_prices_are_those_that_are_given() -> None:
    """Otherwise what a question costs the user would not count."""
    costs = Costs(label=3.0)
    assert episode_settings(PoolWorld(pool_of(), 0, costs=costs).task, 'random_fsq').costs == costs


def test_what_needs_more_than_the_arrays_says_so() -> None:
    """The greedy oracle needs a second draw, and a task alone has no things."""
    world = PoolWorld(pool_of(), 0)
    with pytest.raises(InputError, match='the things of task pool are arrays in a program: its world must be given'):
        world.spec.open()
    settings = episode_settings(world.task, CEILING_SETTINGS)
    evaluation = Evaluation(world.spec, settings, None, world)
    teacher = ScriptedTeacher(world.task.symbols, world.task.relevant_groups, 0)
    with pytest.raises(InputError, match='task pool has no second draw of held-out things'):
        CEILINGS['greedy_oracle'](evaluation, world.task, teacher)
    assert CEILINGS['all_labels'](evaluation, world.task, teacher).final_accuracy > 0.5
    assert world.report() == '60 things from arrays, 30 of them held out'
    assert dataclasses.replace(world, split=1).test_set[1] != world.test_set[1]
