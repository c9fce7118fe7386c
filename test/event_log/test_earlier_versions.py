"""Sessions that a learner with an earlier version of the method began: nothing that was taught in them is lost."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from al_questioner.domain import QueryKind
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import LogContents, SessionLog, SessionLogError, read_log
from al_questioner.event_log.replay import ReplayError, first_divergence
from al_questioner.event_log.state_documents import episode_members
from al_questioner.event_log.storage import Event
from al_questioner.event_log.summary import summarise_session
from al_questioner.questioning import Choice, Strategy, TurnContext
from al_questioner.questioning.semantics import EARLIEST_SEMANTICS, SEMANTICS
from al_questioner.simulation import PerceivedWorld
from shared.durable_sessions import episode_started, events, play_turns


class LabelAt:
    """Strategy that asks for the name of the thing at a place, and draws a random number as it does."""

    selector = None

    def __init__(self, place: int) -> None:
        self.place = place

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        rng.random()
        labels = [i for i, action in enumerate(context.candidates) if action.kind is QueryKind.LABEL]
        return Choice(labels[self.place], np.zeros(len(context.candidates)))


def started_durable(folder: Path, strategy: Strategy, started: EpisodeStarted) -> DurableEpisode:
    durable = DurableEpisode(started, strategy, SessionLog(folder))
    durable.start()
    return durable


def played_durable(folder: Path, world: PerceivedWorld, started: EpisodeStarted, turns: int) -> DurableEpisode:
    """A session of some turns, always about the first thing, that has ended."""
    durable = started_durable(folder, LabelAt(0), started)
    play_turns(durable, world, turns)
    durable.close()
    return durable


@pytest.fixture
def earlier() -> EpisodeStarted:
    return episode_started(semantics=EARLIEST_SEMANTICS)


def test_what_was_asked_by_an_earlier_version_is_taken_as_recorded(
    earlier: EpisodeStarted, tmp_path: Path, world: PerceivedWorld
) -> None:
    """A robot that was updated between two days goes on where it was, and asks as it does now."""
    before = played_durable(tmp_path, world, earlier, 3)
    after = started_durable(tmp_path, LabelAt(-1), episode_started())
    assert after.episode.records == before.episode.records
    scene = world.scene(1).features
    np.testing.assert_array_equal(*(each.episode.concepts.predict_proba(scene) for each in (after, before)))
    assert after.episode._rng.bit_generator.state == before.episode._rng.bit_generator.state
    play_turns(after, world, 1)
    assert after.episode.records[-1].object_id == world.scene(4).object_ids[-1]
    after.close()
    again = started_durable(tmp_path, LabelAt(1), episode_started())
    assert again.episode.records == after.episode.records
    again.close()


def test_another_decision_of_the_same_version_is_an_error(tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise a log of another robot, or a changed strategy, would be gone on with unnoticed."""
    played_durable(tmp_path, world, episode_started(), 2)
    with pytest.raises(ReplayError, match=r'turn 1: .* is chosen, .* was recorded'):
        started_durable(tmp_path, LabelAt(-1), episode_started())


def test_a_check_tells_that_another_version_decided(
    earlier: EpisodeStarted, tmp_path: Path, world: PerceivedWorld
) -> None:
    """Otherwise the difference would look like a fault of the recording."""
    played_durable(tmp_path, world, earlier, 2)
    found = first_divergence(earlier, [event for event in events(tmp_path) if not isinstance(event, EpisodeStarted)])
    assert found is not None
    expected = f'(by version {EARLIEST_SEMANTICS} of the method, this is version {SEMANTICS})'
    assert found.endswith(expected)


def test_a_session_of_an_earlier_version_is_shown_whole(
    earlier: EpisodeStarted, tmp_path: Path, world: PerceivedWorld
) -> None:
    """It can be exported with all that was taught in it."""
    before = played_durable(tmp_path, world, earlier, 3)
    summary = summarise_session(tmp_path, read_log(tmp_path))
    assert summary.fault is None
    assert summary.episode.records == before.episode.records


def test_logs_and_bags_without_a_version_are_of_the_earliest(earlier: EpisodeStarted) -> None:
    """The version is told by logs and bags since there are two."""
    assert episode_members(earlier, ('a',))['semantics'] == EARLIEST_SEMANTICS
    members = earlier.members()
    del members['semantics']
    recorded, damage = decoded(LogContents((Event(1, 'episode', 0, json.dumps(members).encode(), b''),), None))
    assert damage is None
    assert recorded == [earlier]


def test_a_session_from_before_the_new_defaults_is_resumed_with_these(tmp_path: Path, world: PerceivedWorld) -> None:
    """Nobody has to know which parameters a new version has to start the learner as the day before."""
    now = episode_started()
    settings = dataclasses.replace(now.settings, kernel_shape='rbf', class_balance=0.0)
    started = episode_started(semantics=EARLIEST_SEMANTICS, settings=settings)
    before = played_durable(tmp_path, world, started, 2)
    costs = dataclasses.replace(now.settings.costs, relevance=4.0)
    weights = {'gain': 2.0}
    wanted = episode_started(settings=dataclasses.replace(now.settings, costs=costs, weights=weights))
    after = started_durable(tmp_path, LabelAt(0), wanted)
    assert after.started.settings.classifiers == settings.classifiers
    assert after.started.settings.costs.relevance is None
    assert after.episode.records == before.episode.records
    after.close()
    with pytest.raises(SessionLogError, match=r'budget 8\.0, not 9\.0'):
        DurableEpisode(
            episode_started(settings=dataclasses.replace(now.settings, budget=9.0)), LabelAt(0), SessionLog(tmp_path)
        )
