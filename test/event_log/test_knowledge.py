"""Sessions that begin with what an earlier one taught, and what they leave."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from al_questioner.cli import main
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import SessionLogError, read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.messages.knowledge_members import knowledge_members
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings
from shared.durable_sessions import TASK, durable_of, episode_started, play_turns, start_durable


@pytest.fixture(scope='module')
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


@pytest.fixture(scope='module')
def other_world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 5, 5).open())


def going_on(known, budget=3.0, episode_id='e2'):
    settings = dataclasses.replace(episode_settings(TASK, 'farthest_fsq', budget, 6), concepts=known)
    return {'settings': settings, 'episode_id': episode_id}


def test_a_session_leaves_what_it_taught(tmp_path: Path, world: PerceivedWorld) -> None:
    """The file of the command is another one than that of the learner."""
    durable = start_durable(tmp_path / 's')
    play_turns(durable, world, 4)
    durable.close()
    assert main(['session', str(tmp_path / 's'), '--concepts', str(tmp_path / 'c.json')]) == 0
    assert (tmp_path / 'c.json').read_text() == concepts_text(durable.knowledge())
    found = read_concepts(tmp_path / 'c.json')
    assert found == durable.knowledge()
    assert found.lessons[0].stamp == 1000
    assert (found.origins[0].episode, found.origins[0].world) == ('e1', {**(episode_started().world or {})})


def test_a_session_goes_on_tomorrow_and_is_resumed(
    tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld
) -> None:
    """A learner that was killed on the second day forgets the first."""
    first = start_durable(None)
    play_turns(first, world, 6)
    known = first.knowledge()
    second = start_durable(tmp_path / 's', **going_on(known))
    play_turns(second, other_world, 3)
    second.close()

    # The file is gone by now.
    resumed = start_durable(tmp_path / 's', **going_on(None))
    assert resumed.started.settings.concepts == known
    play_turns(resumed, other_world, 3)
    resumed.close()
    events, fault = decoded(read_log(tmp_path / 's'))
    assert fault is None
    begun = events[0]
    assert isinstance(begun, EpisodeStarted)
    assert first_divergence(begun, events[1:]) is None
    summary = summarise_session(tmp_path / 's', read_log(tmp_path / 's'))
    assert summary.knowledge == resumed.knowledge()
    assert summary.knowledge.lessons[: len(known.lessons)] == known.lessons


def test_another_file_is_not_taken_for_the_one_that_was_known(
    tmp_path: Path, world: PerceivedWorld, other_world: PerceivedWorld
) -> None:
    """A session goes on with other beliefs than it asked with; a file that has grown is the same one."""
    first, other = start_durable(None), start_durable(None, episode_id='e0')
    play_turns(first, world, 6)
    play_turns(other, world, 5)
    second = start_durable(tmp_path / 's', **going_on(first.knowledge()))
    play_turns(second, other_world, 2)
    second.close()
    grown = second.knowledge()
    start_durable(tmp_path / 's', **going_on(grown)).close()
    with pytest.raises(SessionLogError, match='concepts_sha256'):
        start_durable(tmp_path / 's', **going_on(other.knowledge()))


def test_old_logs_have_no_concepts(tmp_path: Path, world: PerceivedWorld) -> None:
    """Nothing is to change for those who keep nothing."""
    started = episode_started()
    assert not {'concepts', 'concepts_sha256'} & started.members().keys()
    durable = durable_of(started, None)
    durable.start()
    play_turns(durable, world, 1)
    assert knowledge_members(durable.knowledge())['lessons']
