"""Episodes that a questioner with given weights plays in the demonstrations' own worlds, as a softmax policy."""

from __future__ import annotations

import signal
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import islice
from multiprocessing import get_context

import numpy as np
from scipy.special import softmax

from al_questioner.domain import InputError, random_stream
from al_questioner.imitation.demonstration import Demonstration, teacher_of
from al_questioner.questioning import Choice, Episode, FeatureSet, TurnContext
from al_questioner.questioning.strategies.choice import settled_actions
from al_questioner.simulation import turns
from al_questioner.support.arrays import Array


class SoftmaxQuestioner:
    """Chooses a with probability proportional to exp(w . E[phi|a]): the stochastic policy that imitation assumes.

    Attributes:
        features: per turn so far, (F,) those of what was chosen.
        scores: per turn so far, (F,) gradient of log p(chosen) with respect to the weights.
    """

    selector = None

    def __init__(self, weights: Array, feature_set: FeatureSet) -> None:
        self._weights, self._feature_set = weights, feature_set
        self.features: list[Array] = []
        self.scores: list[Array] = []

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Draw one of the candidates that are not settled and that the strategy considers."""
        features = self._feature_set.of(context)
        settled = settled_actions(context)
        utilities = features @ self._weights
        utilities[[action in settled for action in context.candidates]] = -np.inf
        utilities[self._feature_set.left_out(context, features)] = -np.inf
        probabilities = softmax(utilities)
        index = int(rng.choice(len(utilities), p=probabilities))
        self.features.append(features[index])
        self.scores.append(features[index] - probabilities @ features)
        return Choice(index, np.where(np.isinf(utilities), np.nan, utilities), features)


@dataclass(frozen=True, eq=False)
class Rollout:
    """One episode of the softmax policy.

    Attributes:
        features: (T, F) those of what was chosen in each turn.
        scores: (T, F) gradient of the logarithm of the probability of what was chosen in each turn.
    """

    features: Array
    scores: Array

    @property
    def feature_counts(self) -> Array:
        """Feature counts of the learner, (F,), mean over the turns: phi_L of equation 6."""
        return np.asarray(self.features.mean(axis=0))


class Simulator:
    """Plays rollouts in the worlds of demonstrations, with their limits and prices, in this process or in several.

    What a rollout does depends on the weights and on the name of its random stream alone, not on the process.

    Raises:
        InputError: a demonstration took place in no simulated world, or its world cannot be opened.
    """

    def __init__(self, demonstrations: Sequence[Demonstration], jobs: int = 1) -> None:
        self._stages = [_Stage(demonstration) for demonstration in demonstrations]
        self._pool: ProcessPoolExecutor | None = None
        if jobs > 1:
            # Forked, so that each process inherits the worlds with all that was drawn and measured already.
            fork = get_context('fork')
            self._pool = ProcessPoolExecutor(jobs, fork, initializer=_inherit, initargs=(self._stages,))

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if self._pool is not None:
            if kind is not None:
                # The results of the running jobs are not needed. Only Python 3.14 has a public way to say so.
                for process in (self._pool._processes or {}).values():
                    process.terminate()
            self._pool.shutdown(cancel_futures=True)

    def roll_out(self, weights: Array, count: int, stream: str) -> list[list[Rollout]]:
        """Play rollouts with these weights, (F,), for each demonstration; the stream names their randomness."""
        stages = range(len(self._stages))
        tasks = [(stage, weights, f'{stream}/{number}') for stage in stages for number in range(count)]
        if self._pool is None:
            found = [self._stages[stage].play(w, name) for stage, w, name in tasks]
        else:
            found = list(self._pool.map(_play, tasks, chunksize=max(1, count // 4)))
        return [found[first : first + count] for first in range(0, len(found), count)]


class _Stage:
    """The scenario of one demonstration."""

    def __init__(self, demonstration: Demonstration) -> None:
        try:
            world_spec, self._world = demonstration.world_spec, demonstration.open_world()
        except InputError as error:
            raise InputError(f'{error}; use --method choice, which needs none') from error
        self._seed = world_spec.seed
        self._teacher = teacher_of(world_spec)
        self._settings, self._tolerance = demonstration.settings, demonstration.view_tolerance
        self._feature_set = demonstration.feature_set
        # Of a demonstration that was cut off, a rollout is to be compared with what there is.
        self._turns = demonstration.turns
        for turn in (1, *self._world.change_turns(self._turns)):
            self._world.scene(turn)

    def play(self, weights: Array, stream: str) -> Rollout:
        questioner = SoftmaxQuestioner(weights, self._feature_set)
        rng = random_stream(self._seed, f'rollout/{stream}')
        episode = Episode(self._settings, rng, self._tolerance, questioner)
        for _ in islice(turns(episode, self._world, self._teacher), self._turns):
            pass
        return Rollout(np.array(questioner.features), np.array(questioner.scores))


_STAGES: list[_Stage] = []
"""Stages of the simulator that this process works for."""


def _inherit(stages: Sequence[_Stage]) -> None:
    # It is for the simulator to end its processes, which would print how they were interrupted.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _STAGES[:] = stages


def _play(task: tuple[int, Array, str]) -> Rollout:
    stage, weights, stream = task
    return _STAGES[stage].play(weights, stream)
