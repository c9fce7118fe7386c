"""Unusual scenes of a camera: nothing at all, and nonsense in a stream."""

from __future__ import annotations

import dataclasses
from collections import Counter
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.domain import Scene
from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.messages.stamps import stamp_of
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.types import CLOUD_TYPES, header

NAMES = ('colour_hue', 'size_height')


def scene(count: int) -> Scene:
    features = np.random.default_rng(count).random((count, len(NAMES)), np.float32)
    return Scene(tuple(range(count)), np.zeros((count, 3), np.float32), features, NAMES)


def cloud_of(count: int, turn: dict[str, Any]) -> PointCloud2:
    """Return a cloud of this number of things with the stamp of a turn; below 0 it lacks even the fields."""
    head = header(stamp_of(turn['stamp']), 'camera')
    return PointCloud2(header=head) if count < 0 else cloud_of_scene(scene(count), head, CLOUD_TYPES)


@pytest.mark.parametrize('strategy', ['value_per_cost', 'dt_task_env', 'random_fsq', 'u_sampling'])
def test_an_empty_table_is_a_turn_in_which_nothing_is_asked_about_things(
    graph: Any, tmp_path: Path, strategy: str
) -> None:
    """Otherwise a table that is cleared would stop the episode, until it is laid again."""
    states, queries = graph.listen('learner_state', profile=qos.RECORDED_LATCHED), graph.listen('query')
    turns = graph.listen('turn')
    mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.EVENTS)
    episode = {**graph.episode, 'strategy': strategy, 'turns': 6, 'session': str(tmp_path / 'session')}
    learner = graph.start(LearnerNode, **episode)
    counts = {1: 0, 2: 4, 3: 0, 4: 5, 5: -1, 6: 5}

    def goes_on() -> bool:
        if turns:
            eyes.publish(cloud_of(counts[turns[-1]['turn']], turns[-1]))
        if queries:
            mouth.publish(String(data='colour' if queries[-1]['kind'] == 'feature_subset' else 'none'))
        return bool(states and states[-1]['done'])

    graph.wait_for(goes_on, 'the end of the episode')
    asked = Counter(query['turn'] for query in states[-1]['queries'] if query['kind'] != 'feature_subset')
    assert asked.keys() <= {2, 4, 6}
    assert {state['turn']: len(state['beliefs']) for state in states} == {1: 0, 2: 4, 3: 0, 4: 5, 5: 0, 6: 5}
    graph.stop(learner)
    again = graph.start(LearnerNode, **episode)
    graph.wait_for(lambda: again.machine._durable.is_ready, 'the session to be gone through')
    assert again.machine._durable.episode.turn == 6
    assert not again._failure


def test_a_wrong_reading_of_a_thing_that_stands_still_is_named(graph: Any, capfd: pytest.CaptureFixture[str]) -> None:
    """Otherwise nobody would look for the loose cable: the learner keeps the earlier reading in silence."""
    turns, states = graph.listen('turn'), graph.listen('learner_state', profile=qos.RECORDED_LATCHED)
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.EVENTS)
    learner = graph.start(LearnerNode, **{**graph.episode, 'strategy': 'random_fsq', 'budget': 0.0, 'turns': 3})
    still = scene(6)

    def goes_on() -> bool:
        if turns:
            features = still.features.copy()
            if turns[-1]['turn'] == 3:
                features[4, 1] = 65535
            shown = dataclasses.replace(still, features=features)
            eyes.publish(cloud_of_scene(shown, header(stamp_of(turns[-1]['stamp']), 'camera'), CLOUD_TYPES))
        return bool(states and states[-1]['done'])

    graph.wait_for(goes_on, 'the end of the episode')
    assert learner.measurements()['implausible size_height'] == '65535 of object 4'
    assert capfd.readouterr().err.count('size_height of object 4 reads 65535, far from all else it ever read') == 1


def test_a_stream_of_nonsense_is_logged_once_a_second(graph: Any, capfd: pytest.CaptureFixture[str]) -> None:
    """Otherwise ten warnings a second would hide all others."""
    learner = graph.start(LearnerNode, **graph.episode)
    for number in range(300):
        learner.reject('objects', f'feature colour_{number} of object {number} is not finite (nan)')
        learner.reject('objects', 'the cloud has no field object_id')
    said = capfd.readouterr().err
    seconds = 1 + said.count('other refusals were only counted')
    assert said.count('is not finite') <= seconds
    assert said.count('has no field') <= seconds
    assert said.count('is not finite') >= 1 <= said.count('has no field')
    assert learner.counts() == {'refused on objects': 600}


@pytest.mark.parametrize(('count', 'said'), [(1, '1 other refusal was'), (2, '2 other refusals were')])
def test_refusals_that_were_not_logged_are_counted_in_english(
    graph: Any, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, count: int, said: str
) -> None:
    """Otherwise it would say that 1 other refusals were counted."""
    learner = graph.start(LearnerNode, **graph.episode)
    monkeypatch.setattr(learner, '_said', SimpleNamespace(passes=lambda _: True, held_back=lambda: count))
    learner.reject('objects', 'the cloud has no field object_id')
    assert f'({said} only counted)' in capfd.readouterr().err
