"""An episode in one process with a stopwatch in every gap: `simulation.play`, taken apart."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np
from measuring import Seconds

from al_questioner.domain import Answer, Decision, EpisodeSettings, QueryRecord, Scene, random_stream
from al_questioner.questioning import Episode
from al_questioner.simulation import Evaluation, ScriptedTeacher, WorldSpec

RENDERING = 'drawing the simulated table'
PERCEIVING = 'perceiving it'
CHOOSING = 'choosing what to ask'
ANSWERING = 'answering'
LEARNING = 'learning from the answer'
EVALUATING = 'evaluating on held-out images'
BELIEFS = 'what is believed then'

OFFLINE_STAGES = (RENDERING, PERCEIVING, CHOOSING, ANSWERING, LEARNING, EVALUATING)
GRAPH_STAGES = (RENDERING, PERCEIVING, CHOOSING, ANSWERING, LEARNING, BELIEFS)
"""Stages of the nodes between two messages; nobody evaluates there, but the learner publishes what it believes."""


class Stages:
    """Seconds of each stage in each turn."""

    def __init__(self, turns: int) -> None:
        self.seconds: dict[str, Seconds] = {}
        self._turns = turns

    @contextmanager
    def timed(self, stage: str, turn: int) -> Iterator[None]:
        """Add what happens inside to a stage of a turn (1-based)."""
        start = time.perf_counter()
        yield
        self.seconds.setdefault(stage, np.zeros(self._turns))[turn - 1] += time.perf_counter() - start


@dataclass(frozen=True, eq=False)
class PlayedTurn:
    """All that the messages of a turn tell.

    Attributes:
        scene: what was seen.
        decision: what was weighed and asked.
        answer: None if nothing was asked.
        record: what came of the query, None if nothing was asked.
        beliefs: (|X|, |Y|) q_y(x) of the scene at the end of the turn.
    """

    scene: Scene
    decision: Decision
    answer: Answer | None
    record: QueryRecord | None
    beliefs: np.ndarray


@dataclass(frozen=True, eq=False)
class PlayedEpisode:
    """An episode and the time it took.

    Attributes:
        making: seconds to make the world and to look at the held-out images.
        seconds: (turns,) of each stage, by its name.
        turns: what happened in each.
        final_accuracy: on the held-out images.
    """

    making: float
    seconds: Mapping[str, Seconds]
    turns: tuple[PlayedTurn, ...]
    final_accuracy: float

    @property
    def records(self) -> tuple[QueryRecord, ...]:
        """The queries, in order."""
        return tuple(turn.record for turn in self.turns if turn.record is not None)

    @property
    def offline_total(self) -> float:
        """Seconds of the whole episode as `run_episode` plays it, where no beliefs are shown."""
        return self.making + sum(float(self.seconds[stage].sum()) for stage in OFFLINE_STAGES if stage in self.seconds)

    def per_turn(self, stages: tuple[str, ...]) -> Seconds:
        """(turns,) seconds of these stages together."""
        return np.sum([self.seconds.get(stage, np.zeros(len(self.turns))) for stage in stages], axis=0)


def play_timed(world_spec: WorldSpec, settings: EpisodeSettings, teacher: ScriptedTeacher) -> PlayedEpisode:
    """Play the episode of `run_episode`, with the stopwatch on."""
    start = time.perf_counter()
    episode = Episode(settings, random_stream(world_spec.seed, 'learner'))
    evaluation = Evaluation(world_spec, settings, episode.strategy.selector)
    making = time.perf_counter() - start
    world = evaluation.world
    stages = Stages(settings.turns)
    turns = []
    accuracy = float('nan')
    for turn in range(1, settings.turns + 1):
        with stages.timed(RENDERING, turn):
            world.observations(turn)
        with stages.timed(PERCEIVING, turn):
            scene = world.scene(turn)
        with stages.timed(CHOOSING, turn):
            decision = episode.ask(scene)
        answer = record = None
        if decision.query is not None:
            with stages.timed(ANSWERING, turn):
                answer = teacher.answer(decision.query, world.truth(turn))
            with stages.timed(LEARNING, turn):
                record = episode.tell(answer)
        with stages.timed(BELIEFS, turn):
            beliefs = episode.concepts.predict_proba(scene.features)
        with stages.timed(EVALUATING, turn):
            accuracy = evaluation.next_turn(record, episode.concepts)
        turns.append(PlayedTurn(scene, decision, answer, record, beliefs))
    return PlayedEpisode(making, stages.seconds, tuple(turns), accuracy)
