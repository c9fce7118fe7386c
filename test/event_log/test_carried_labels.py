"""Sessions and bags of learners whose labels follow things."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from al_questioner.bags import read_episodes
from al_questioner.cli import main
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import SessionLogError, read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.state_documents import episode_members
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages import documents
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings
from shared.durable_sessions import TASK, durable_of, episode_started, play_turns, start_durable

QUICK = dataclasses.replace(TASK, scenes=dataclasses.replace(TASK.scenes, change_interval=3))
SETTINGS = dataclasses.replace(episode_settings(QUICK, 'u_sampling_fsq', 20.0, 12), carry_labels=True)


@pytest.fixture(scope='module')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(QUICK, 4, 4).open())


def carried(durable) -> list[tuple[int, int]]:
    return [(view.object_id, view.turn) for view in durable.episode.concepts.labelled_views if view.is_carried]


def test_a_resumed_session_believes_what_it_would_have(tmp_path: Path, world: PerceivedWorld) -> None:
    """Labels that were carried before the learner was killed are lost, or carried twice."""
    whole = start_durable(None, settings=SETTINGS)
    play_turns(whole, world, 10)
    before = start_durable(tmp_path / 's', settings=SETTINGS)
    play_turns(before, world, 7)
    assert carried(before)
    before.close()
    resumed = start_durable(tmp_path / 's', settings=SETTINGS)
    assert carried(resumed) == carried(before)
    play_turns(resumed, world, 3)
    resumed.close()
    assert resumed.episode.records == whole.episode.records
    assert carried(resumed) == carried(whole)
    looks = world.scene(10).features
    assert np.array_equal(resumed.episode.concepts.predict_proba(looks), whole.episode.concepts.predict_proba(looks))
    assert resumed.knowledge().lessons == whole.knowledge().lessons
    events, fault = decoded(read_log(tmp_path / 's'))
    assert fault is None
    assert isinstance(events[0], EpisodeStarted)
    assert first_divergence(events[0], events[1:]) is None
    assert summarise_session(tmp_path / 's', read_log(tmp_path / 's')).knowledge == resumed.knowledge()


def test_a_session_does_not_change_its_mind(tmp_path: Path, world: PerceivedWorld) -> None:
    """Half of a session carries labels and the other half does not, and no replay leads to what was asked."""
    without = dataclasses.replace(SETTINGS, carry_labels=False)
    for folder, first, second, said in (('a', SETTINGS, without, 'True, not False'), ('b', without, SETTINGS, 'False')):
        durable = start_durable(tmp_path / folder, settings=first)
        play_turns(durable, world, 1)
        durable.close()
        with pytest.raises(SessionLogError, match=f'carry_labels {said}'):
            start_durable(tmp_path / folder, settings=second)


def test_a_bag_tells_of_it_and_is_checked(tmp_path: Path, world: PerceivedWorld) -> None:
    """Somebody who gets the bag cannot play the episode again."""
    durable = start_durable(tmp_path / 's', settings=SETTINGS)
    play_turns(durable, world, 12)
    durable.close()
    options = ['--bag', str(tmp_path / 'bag'), '--json', str(tmp_path / 'j'), '--concepts', str(tmp_path / 'c')]
    assert main(['session', str(tmp_path / 's'), *options]) == 0
    (episode,) = read_episodes(tmp_path / 'bag')
    assert episode.started.settings.carry_labels
    assert first_divergence(episode.started, episode.events) is None
    assert main(['replay', '--check', str(tmp_path / 'bag')]) == 0
    lessons = json.loads((tmp_path / 'c').read_text())['lessons']
    assert any('carried_from' in label for lesson in lessons for label in lesson.get('labels', ()))


def test_documents_tell_of_it_only_where_it_is_on() -> None:
    """Logs and bags of those who do not use it are others than before, or older ones cannot be read."""
    for carries in (False, True):
        started = episode_started(settings=dataclasses.replace(SETTINGS, carry_labels=carries))
        members = episode_members(started, ('a',))
        assert members.get('carry_labels') is (True if carries else None)
        read = documents.read('episode', documents.write('episode', 'e1', members))
        assert documents.settings_of(read).carry_labels is carries
    with pytest.raises(documents.DocumentError, match='carry_labels'):
        documents.read('episode', documents.write('episode', 'e1', {**members, 'carry_labels': 'yes'}))
    assert durable_of(episode_started(), None).started.settings.carry_labels is False
