"""A log leads an episode to where it was, or it is said where it does not."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

from al_questioner.domain import Answer, Outcome, SettingsError
from al_questioner.event_log.events import AnswerAccepted, EpisodeStarted, KernelTuned, TurnTimedOut
from al_questioner.event_log.replay import ReplayError, replay_of
from al_questioner.simulation import PerceivedWorld
from shared.durable_sessions import Start, ask, episode_started, events, play_turns


def test_a_log_that_leads_elsewhere_is_an_error(start: Start, tmp_path: Path, world: PerceivedWorld) -> None:
    """Otherwise a robot of another version would go on as if it had asked what it never asks."""
    durable = start()
    play_turns(durable, world, 2)
    found = events(tmp_path)
    replay = replay_of(
        episode_started(settings=dataclasses.replace(episode_started().settings, strategy='rarest_demo'))
    )

    def play_all() -> None:
        for event in found[1:]:
            replay.play(event)

    with pytest.raises(ReplayError, match=r'turn \d: .* is chosen, .* was recorded'):
        play_all()
    first = found[0]
    assert isinstance(first, EpisodeStarted)
    for odd, reason in (
        (first, 'another episode begins'),
        (found[2], 'not about the scene of the next turn'),
        (AnswerAccepted(Answer('q1', 'a1', 'x', Outcome.SKIP)), 'turn 0: answer: no query is pending'),
        (KernelTuned(7, 3), 'recorded were version 3 and turn 7'),
    ):
        with pytest.raises(ReplayError, match=reason):
            replay_of(episode_started()).play(odd)


def test_an_unknown_strategy_is_named(tmp_path: Path) -> None:
    """Otherwise a strategy that is not installed any more would end in a traceback."""
    unknown = dataclasses.replace(episode_started().settings, strategy='clever')
    with pytest.raises(SettingsError, match='unknown strategy'):
        replay_of(episode_started(settings=unknown))


def test_a_turn_that_passed_without_waiting_is_named(start: Start, world: PerceivedWorld) -> None:
    """Otherwise a learner would continue a log that was tampered with."""
    durable = start()
    query = ask(durable, world).query
    replay = replay_of(durable.started)
    with pytest.raises(ReplayError, match='q1 does not wait for an answer'):
        replay.play(TurnTimedOut(1, query.query_id))
