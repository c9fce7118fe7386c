"""Resemblance of a questioner with given weights to an expert that it was not trained on."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np
from scipy.special import log_softmax

from al_questioner.domain import Classifiers, Outcome, QueryKind, QueryRecord, random_stream
from al_questioner.imitation.demonstration import Demonstration, Step, all_steps, teacher_of
from al_questioner.questioning import Episode, FeatureRecorder, make_strategy
from al_questioner.questioning.strategies.choice import TIE
from al_questioner.simulation import PerceivedWorld, turns
from al_questioner.support.arrays import Array


@dataclass(frozen=True)
class Agreement:
    """With an expert's steps, in the states that the expert was in; means over the steps.

    Attributes:
        log_likelihood: log p(chosen) of the softmax policy, in nats a step; at most 0.
        kind: probability that the best candidate, ties broken at random, is of the expert's kind.
        ask: probability that the best candidate asks when the expert asks, and nothing when the expert does not.
        choice: probability that the best candidate is the expert's.
    """

    log_likelihood: float
    kind: float
    ask: float
    choice: float


def agreement(weights: Array, demonstrations: Sequence[Demonstration]) -> Agreement:
    """Measure the agreement of the questioner with these weights (F,), whose scale is that of the softmax."""
    rows = [_agreement_of_step(weights, step) for step in all_steps(demonstrations)]
    return Agreement(*(float(value) for value in np.mean(rows, axis=0)))


def _agreement_of_step(weights: Array, step: Step) -> tuple[float, float, float, float]:
    utilities = step.features @ weights
    best = utilities >= utilities.max() - TIE * abs(utilities.max())
    kinds = [action.kind for action in step.actions]
    same_kind = np.array([kind is step.kind for kind in kinds])
    asks = np.array([kind is not QueryKind.NO_QUERY for kind in kinds])
    same_ask = asks == (step.kind is not QueryKind.NO_QUERY)
    log_likelihood = log_softmax(utilities)[step.chosen]
    return log_likelihood, same_kind[best].mean(), same_ask[best].mean(), best[step.chosen] / best.sum()


@dataclass(frozen=True, eq=False)
class Imitation:
    """The learner in a demonstration's place: same world, budget and time, asking by itself; counts are (F,)."""

    feature_counts: Array
    queries: tuple[QueryRecord, ...]


def imitate(
    weights: Array, demonstration: Demonstration, world: PerceivedWorld, classifiers: Classifiers | None = None
) -> Imitation:
    """Play the demonstration's episode, as far as it goes, with the strategy that is trained and these weights (F,).

    The learner has these classifiers, or those of the demonstration if none are given.

    Raises:
        InputError: the demonstration took place in no world that can be played in.
    """
    world_spec = demonstration.world_spec
    feature_set = demonstration.feature_set
    named = dict(zip(feature_set.names, map(float, weights), strict=True))
    settings = dataclasses.replace(demonstration.settings, strategy=feature_set.strategy, weights=named)
    if classifiers is not None:
        settings = dataclasses.replace(settings, **classifiers._asdict())
    learner = FeatureRecorder(make_strategy(settings.strategy, named), feature_set)
    episode = Episode(settings, random_stream(world_spec.seed, 'learner'), demonstration.view_tolerance, learner)
    played = [decision for decision, _ in islice(turns(episode, world, teacher_of(world_spec)), demonstration.turns)]
    counts = np.mean([decision.features[decision.chosen] for decision in played], axis=0)
    return Imitation(np.asarray(counts), episode.records)


def predict_queries(weights: Array, demonstration: Demonstration) -> tuple[QueryRecord, ...]:
    """Return the queries of a learner with these weights (F,) in each of the states that the expert was in."""
    found = []
    for step in demonstration.steps:
        action = step.actions[int(np.argmax(step.features @ weights))]
        if action.kind is not QueryKind.NO_QUERY:
            cost = demonstration.settings.costs.price(action.kind)
            found.append(QueryRecord(step.turn, action.kind, action.object_id, action.symbol, cost, Outcome.ANSWERED))
    return tuple(found)
