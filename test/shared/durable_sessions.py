"""Sessions of a learner for the tests of the log: begun, played for some turns, and read again."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

from al_questioner.domain import Answer, Decision
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.questioning import Receipt
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.lunches import TASK, teacher

TEACHER = teacher()
WORLD = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}
Start = Callable[..., DurableEpisode]


def begun(**changes: object) -> EpisodeStarted:
    settings = episode_settings(TASK, 'u_sampling_fsq', 8.0, 6, tune_every=2)
    return dataclasses.replace(EpisodeStarted('e1', settings, 4, 1e-3, WORLD, '1'), **changes)


def started(folder: Path | None, **changes: object) -> DurableEpisode:
    session = DurableEpisode(begun(**changes), None if folder is None else SessionLog(folder))
    session.start()
    return session


def ask(session: DurableEpisode, world: PerceivedWorld) -> Decision:
    turn = session.episode.turn + 1
    return session.ask(SceneObserved(turn, turn * 1000, 'table', world.scene(turn)))


def answer(session: DurableEpisode, world: PerceivedWorld) -> Answer:
    query = session.episode.pending
    assert query is not None
    return TEACHER.answer(query, world.truth(query.turn))


def play_turns(session: DurableEpisode, world: PerceivedWorld, n: int) -> list[Answer]:
    """Some whole turns, and the answers."""
    said = []
    for _ in range(n):
        if ask(session, world).query is not None:
            said.append(answer(session, world))
            assert session.take(said[-1]) is Receipt.ACCEPTED
        session.tune()
    return said


def events(folder: Path) -> list[object]:
    found, fault = decoded(read_log(folder))
    assert fault is None
    return list(found)
