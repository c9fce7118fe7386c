"""Sessions of a learner for the tests of the log: started, played for some turns, and read again."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

from al_questioner.domain import Action, Answer, Costs, Decision, QueryKind
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.questioning import Picker, Receipt, TurnContext, make_strategy
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.lunches import TASK, teacher

TEACHER = teacher()
WORLD = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}
Start = Callable[..., DurableEpisode]


WITH_RELEVANCE = dataclasses.replace(episode_settings(TASK, 'human', 20.0, 6), costs=Costs(relevance=4.0))
"""Settings of an episode whose questioner may ask which things matter."""


def ask_what_matters(context: TurnContext) -> int:
    """Ask which things matter where that is not known, else for the name of the first thing without one."""
    relevance = Action(QueryKind.RELEVANCE)
    if relevance in context.candidates and relevance not in context.known_answers:
        return context.candidates.index(relevance)
    unlabelled = [i for i, known in zip(context.scene.object_ids, context.labelled, strict=True) if not known]
    label = Action(QueryKind.LABEL, next(iter(unlabelled), None))
    return context.candidates.index(label if label in context.candidates else Action(QueryKind.NO_QUERY))


def episode_started(**changes: object) -> EpisodeStarted:
    settings = episode_settings(TASK, 'u_sampling_fsq', 8.0, 6)
    return dataclasses.replace(EpisodeStarted('e1', settings, 4, 1e-3, WORLD, '1'), **changes)


def durable_of(started: EpisodeStarted, log: SessionLog | None, pick: Picker | None = None) -> DurableEpisode:
    strategy = make_strategy(started.settings.strategy, started.settings.weights, pick)
    return DurableEpisode(started, strategy, log)


def start_durable(folder: Path | None, pick: Picker | None = None, **changes: object) -> DurableEpisode:
    durable = durable_of(episode_started(**changes), None if folder is None else SessionLog(folder), pick)
    durable.start()
    return durable


def ask(durable: DurableEpisode, world: PerceivedWorld) -> Decision:
    turn = durable.episode.turn + 1
    return durable.ask(SceneObserved(turn, turn * 1000, 'table', world.scene(turn)))


def answer(durable: DurableEpisode, world: PerceivedWorld) -> Answer:
    query = durable.episode.pending
    assert query is not None
    return TEACHER.answer(query, world.truth(query.turn))


def play_turns(durable: DurableEpisode, world: PerceivedWorld, n: int) -> list[Answer]:
    """Some whole turns, and the answers."""
    said = []
    for _ in range(n):
        if ask(durable, world).query is not None:
            said.append(answer(durable, world))
            assert durable.take(said[-1]).receipt is Receipt.ACCEPTED
    return said


def events(folder: Path) -> list[object]:
    found, fault = decoded(read_log(folder))
    assert fault is None
    return list(found)
