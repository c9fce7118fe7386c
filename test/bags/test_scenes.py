"""The scenes of a bag are those that its learner took, turn by turn."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from al_questioner.bags import BagError, BagWriter, Topic, deserialize, read_bag, read_episodes
from al_questioner.bags.scenes import scenes_of
from al_questioner.domain import Scene
from al_questioner.messages.clouds import cloud_of_scene, scene_of_cloud
from shared.bags import STRING, text


def test_every_turn_has_the_scene_that_its_learner_took(bags, tmp_path):
    """Otherwise a second learner would learn from other things than the first one saw."""
    bags.write_episode(tmp_path / 'b')
    found = scenes_of(read_bag(tmp_path / 'b'))
    (episode,) = read_episodes(tmp_path / 'b')
    assert found.world == episode.started.world
    assert list(found.clouds) == [turn.turn for turn in episode.turns]
    for turn in episode.turns:
        scene = scene_of_cloud(deserialize(found.clouds[turn.turn]))
        assert scene.object_ids == turn.scene.object_ids
        assert scene.features.tobytes() == turn.scene.features.tobytes()


def test_turns_and_objects_are_enough(bags, tmp_path):
    """Otherwise a robot's own recording, without decisions, could not be shown to a learner."""
    missing = [(name, turn) for name in ('decision', 'learner_state', 'episode') for turn in range(1, 9)]
    bags.write_episode(tmp_path / 'b', missing=missing)
    assert len(scenes_of(read_bag(tmp_path / 'b')).clouds) == 8


def test_a_turn_whose_scene_is_missing_is_left_out(bags, tmp_path):
    """Otherwise the scene of the next turn would be shown in its place."""
    bags.write_episode(tmp_path / 'b', missing=[('objects', 3), ('objects', 8)])
    assert list(scenes_of(read_bag(tmp_path / 'b')).clouds) == [1, 2, 4, 5, 6, 7]


def test_of_a_camera_the_first_cloud_that_is_not_older_than_the_turn_counts(bags, tmp_path):
    """Otherwise a cloud that the learner passed over would be shown."""
    lived = bags.write_episode(tmp_path / 'scenes', n_turns=4)
    scenes = [lived.world.scene(turn) for turn in range(1, 4)]
    writing = bags.Writing(tmp_path / 'b')
    for turn in (1, 2):
        begin = bags.START + turn * 1000
        writing.begin_turn(turn, begin, None)
        for late, scene in zip((-1, 5, 9), scenes, strict=True):
            cloud = cloud_of_scene(scene, writing.header(begin + late), writing.cloud_types)
            writing.send('objects', cloud, begin + 50)
    writing.bag.close()
    found = scenes_of(read_bag(tmp_path / 'b'))
    assert found.world is None
    for turn in (1, 2):
        header = deserialize(found.clouds[turn]).header
        assert header.stamp.nanosec == (bags.START + turn * 1000 + 5) % 10**9
        np.testing.assert_array_equal(scene_of_cloud(deserialize(found.clouds[turn])).features, scenes[1].features)


def test_what_holds_no_scenes_of_one_episode_is_refused(bags, tmp_path):
    """Otherwise a learner would wait for ever, or see the scenes of two robots in turn."""
    bags.write_episode(tmp_path / 'none', missing=[('objects', turn) for turn in range(1, 9)])
    two, broken = (bags.Writing(tmp_path / name) for name in ('two', 'broken'))
    for at, episode_id in enumerate(('e1', 'e2')):
        two.begin_turn(1, 10**9, None, episode_id, bags.START + at)
    broken.begin_turn(0, 10**9, None)
    for writing in (two, broken):
        writing.bag.close()
    with BagWriter(tmp_path / 'text', [Topic('/r/objects', STRING, True)]) as bag:
        bag.write('/r/objects', text(''), bags.START)
    for name, reason in (
        ('none', 'no turn with its objects was recorded'),
        ('two', 'holds the scenes of several episodes: e1, e2'),
        ('text', 'no turn with its objects was recorded'),
        ('broken', r'no turn with its objects was recorded in it \(/robot/turn: turn: turn'),
    ):
        with pytest.raises(BagError, match=f'{name}: {reason}'):
            scenes_of(read_bag(tmp_path / name))


def test_an_empty_cloud_without_fields_is_a_scene_as_it_is_for_the_learner(bags, tmp_path):
    """Otherwise a camera that saw an empty table would make its recording useless."""

    def add_empty(writing, members):
        stamp = bags.START + 3 * bags.PERIOD
        nothing = Scene((), np.empty((0, 3)), np.empty((0, 1)), ('a',))
        cloud = cloud_of_scene(nothing, writing.header(stamp), writing.cloud_types)
        writing.send('objects', dataclasses.replace(cloud, fields=[], point_step=0), stamp + 1)

    bags.write_episode(tmp_path / 'b', missing=[('objects', 3)], then=add_empty)
    assert list(scenes_of(read_bag(tmp_path / 'b')).clouds) == [1, 2, 3, 4, 5, 6, 7, 8]
    (episode,) = read_episodes(tmp_path / 'b')
    assert [len(turn.scene.object_ids) for turn in episode.turns if turn.turn in (2, 3)] == [10, 0]
