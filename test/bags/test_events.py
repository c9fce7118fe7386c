"""The events that a bag tells of: those of the session log that it was written from, as far as a bag tells them."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from al_questioner.bags import RecordedEpisode, read_episodes
from al_questioner.bags.events import NOT_RECORDED
from al_questioner.bags.from_session import write_bag
from al_questioner.domain import Answer, Outcome, QueryKind, QueryRecord
from al_questioner.event_log.events import ActionChosen, AnswerAccepted, SceneObserved, TurnTimedOut
from al_questioner.event_log.log import read_log
from al_questioner.event_log.replay import first_divergence
from al_questioner.event_log.summary import summarise_session
from al_questioner.imitation.bags import demonstration_of
from al_questioner.imitation.choice_likelihood import fit_choices
from al_questioner.questioning import FEATURE_SETS
from al_questioner.simulation import PerceivedWorld, WorldSpec
from shared.durable_sessions import (
    TASK,
    WITH_RELEVANCE,
    answer,
    ask,
    ask_what_matters,
    events,
    play_turns,
    start_durable,
)


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """A session in which an answer was corrected, another came a turn late, and another not at all."""
    world = PerceivedWorld(WorldSpec(TASK, 4, 4).open())
    durable = start_durable(tmp_path / 'log')
    (first, *_) = play_turns(durable, world, 2)
    ask(durable, world)
    durable.take(Answer(first.query_id, 'c1', 'anna', Outcome.UNKNOWN, replaces=first.answer_id))
    durable.time_out()
    late = ask(durable, world)
    assert late.query is None
    assert durable.episode.pending is not None
    durable.take(Answer(durable.episode.pending.query_id, 'a3', 'bert', Outcome.SKIP))
    play_turns(durable, world, 1)
    assert ask(durable, world).query is not None
    durable.time_out()
    durable.close()
    return tmp_path / 'log'


@pytest.fixture
def recorded(log: Path, tmp_path: Path) -> RecordedEpisode:
    write_bag(summarise_session(log, read_log(log)), tmp_path / 'bag')
    (episode,) = read_episodes(tmp_path / 'bag')
    return episode


@pytest.fixture
def with_relevance(tmp_path: Path) -> Path:
    """A session in which it was asked which things matter, answered, and corrected: nothing does."""
    world = PerceivedWorld(WorldSpec(TASK, 4, 4).open())
    durable = start_durable(tmp_path / 'log', ask_what_matters, settings=WITH_RELEVANCE)
    (first, *_) = play_turns(durable, world, 2)
    assert first.content == world.scene(1).object_ids, 'every thing of a lunch matters'
    ask(durable, world)
    durable.take(Answer(first.query_id, 'c1', 'anna', Outcome.ANSWERED, (), replaces=first.answer_id))
    durable.take(answer(durable, world))
    play_turns(durable, world, 3)
    durable.close()
    return tmp_path / 'log'


def told(event: object) -> object:
    """Return what a bag holds of an event of a log."""
    if isinstance(event, SceneObserved):
        return event.turn, event.stamp, event.frame_id, event.scene.features.tobytes()
    if isinstance(event, ActionChosen):
        return event.turn, event.action
    if isinstance(event, AnswerAccepted):
        answer = event.answer
        return answer.query_id, answer.outcome, answer.content, answer.replaces is not None
    if isinstance(event, TurnTimedOut):
        return event.turn
    return event


def test_bag_and_log_tell_of_the_same_events(log: Path, recorded: RecordedEpisode) -> None:
    """A replay does not depend on where the episode was written down."""
    started, *others = events(log)
    assert dataclasses.replace(recorded.started, version=started.version) == started
    assert [(type(event), told(event)) for event in recorded.events] == [(type(e), told(e)) for e in others]
    assert {type(event) for event in others} == {SceneObserved, ActionChosen, AnswerAccepted, TurnTimedOut}
    assert first_divergence(started, others) is None
    assert first_divergence(recorded.started, recorded.events) is None


def test_what_a_bag_does_not_tell_is_not_made_up(recorded: RecordedEpisode) -> None:
    """Otherwise somebody would look for a teacher who does not exist, or take a guess for what was recorded."""
    answers = [event.answer for event in recorded.events if isinstance(event, AnswerAccepted)]
    assert {answer.teacher_id for answer in answers} == {NOT_RECORDED}
    assert [answer.answer_id for answer in answers if answer.query_id == 'q1'] == ['not recorded 1', 'not recorded 2']
    assert {event.query_id for event in recorded.events if isinstance(event, TurnTimedOut)} == {None}
    assert {event.query for event in recorded.events if isinstance(event, ActionChosen)} == {None}


def test_a_bag_tells_what_was_said_to_matter(with_relevance: Path, tmp_path: Path) -> None:
    """Otherwise a replay would not know what the robot knew, and nothing could be learnt from its questions."""
    write_bag(summarise_session(with_relevance, read_log(with_relevance)), tmp_path / 'bag')
    (recorded,) = read_episodes(tmp_path / 'bag')
    started, *others = events(with_relevance)
    assert recorded.started.settings == started.settings == WITH_RELEVANCE
    assert [(type(event), told(event)) for event in recorded.events] == [(type(e), told(e)) for e in others]
    assert first_divergence(started, others) is None
    assert first_divergence(recorded.started, recorded.events) is None
    assert recorded.records[0] == QueryRecord(1, QueryKind.RELEVANCE, None, None, 4.0, Outcome.ANSWERED, objects=())
    for name, feature_set in FEATURE_SETS.items():
        demonstration = demonstration_of(recorded, 'it', feature_set)
        assert len(demonstration.steps) > 1, name
        kinds = {action.kind for step in demonstration.steps for action in step.actions}
        assert kinds.isdisjoint(feature_set.passed_over)
    weights = fit_choices([demonstration_of(recorded, 'it')])
    assert np.isfinite(weights).all()
