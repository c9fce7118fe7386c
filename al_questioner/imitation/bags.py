"""Demonstrations from bags."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from al_questioner.bags import BagError, LeftOut, RecordedEpisode, RecordedTurn, read_episodes
from al_questioner.domain import DECISION_FEATURES, Decision, EpisodeSettings, InputError
from al_questioner.event_log.events import ActionChosen
from al_questioner.event_log.replay import Replay, ReplayError
from al_questioner.imitation.demonstration import Demonstration, UnknownWorld, steps_of
from al_questioner.messages.documents import Document
from al_questioner.questioning import FEATURE_SETS, Choice, FeatureRecorder, FeatureSet, TurnContext
from al_questioner.simulation import WorldSpec, load_task

AS_RECORDED: Mapping[str, Any] = MappingProxyType({})
"""No setting of the classifiers by name: all are as they were recorded."""


def read_demonstrations(
    paths: Sequence[Path],
    feature_set: FeatureSet = FEATURE_SETS['dt_task_env'],
    left_out: list[str] | None = None,
    classifiers: Mapping[str, Any] = AS_RECORDED,
) -> list[Demonstration]:
    """Return the demonstrations of several bags, in the order given; a bag may hold several episodes.

    If a list `left_out` is given, it takes what of the bags cannot be used, beside what can; if not, all must be.
    `classifiers` are settings of the learner's classifiers, by name, that are not to be as recorded.

    Raises:
        InputError: a bag that is none, broken, of something else, or whose decisions hold nothing to learn from; or an
            episode that is in them twice.
    """
    named: list[tuple[str, RecordedEpisode]] = []
    for path in paths:
        missing: list[LeftOut] = []
        episodes = read_episodes(path, None if left_out is None else missing)
        if left_out is not None:
            left_out += [f'{path}: {what} is left out: {reason}' for what, reason in missing]
        for number, episode in enumerate(episodes, 1):
            named.append((path.name if len(episodes) == 1 else f'{path.name} ({number})', episode))
    for (name, one), (other_name, other) in combinations(named, 2):
        if is_same_episode(one, other):
            raise InputError(f'{other_name} holds the same episode as {name}: leave one of them out')
    return [demonstration_of(episode, name, feature_set, classifiers) for name, episode in named]


def is_same_episode(one: RecordedEpisode, other: RecordedEpisode) -> bool:
    """Return whether two recordings show the same, turn for turn, whatever their files, topics and times are.

    Of the same `episode_id` one may have ended earlier than the other.
    """
    if one.started.settings != other.started.settings:
        return False
    if one.turns_over != other.turns_over and one.started.episode_id != other.started.episode_id:
        return False
    return all(_shown(ours) == _shown(theirs) for ours, theirs in zip(one.turns, other.turns, strict=False))


def _shown(turn: RecordedTurn) -> tuple[object, ...]:
    chosen = turn.decision.candidates[turn.decision.chosen]
    return turn.scene.object_ids, turn.scene.features.tobytes(), chosen, turn.record


def demonstration_of(
    episode: RecordedEpisode,
    name: str,
    feature_set: FeatureSet = FEATURE_SETS['dt_task_env'],
    classifiers: Mapping[str, Any] = AS_RECORDED,
) -> Demonstration:
    """Return what a recorded episode shows of its questioner.

    With other `classifiers`, see `read_demonstrations`, the choices are the recorded ones, and the features are what
    these classifiers make of the scenes and answers.

    Raises:
        BagError: its decisions hold no decision features, or chose what was not considered.
        SettingsError: a setting of the classifiers outside its range.
    """
    started = episode.started
    settings = dataclasses.replace(started.settings, **classifiers)
    try:
        # A bag holds the decision features; all others are those of what the learner knew at the time.
        if feature_set.names == DECISION_FEATURES and settings == started.settings:
            decisions: Iterable[Decision] = [turn.decision for turn in episode.turns]
        else:
            decisions = decisions_anew(episode, feature_set, settings)
        steps = steps_of(decisions, feature_set.passed_over)
    except InputError as error:
        raise BagError(f'{episode.source}: strategy {started.settings.strategy}: {error}') from error
    return Demonstration(
        name=name,
        settings=settings,
        world=None if started.world is None else _world(started.world, started.settings.symbols),
        turns=episode.turns_over,
        steps=steps,
        feature_names=episode.feature_names,
        queries=episode.records,
        change_turns=episode.change_turns,
        view_tolerance=started.view_tolerance,
        feature_set=feature_set,
    )


def decisions_anew(
    episode: RecordedEpisode, feature_set: FeatureSet, settings: EpisodeSettings | None = None
) -> Iterator[Decision]:
    """Yield the decisions of the turns that are over as they were made, but with features that were not recorded.

    The settings are those of the episode, or, to have other classifiers, these.

    Raises:
        InputError: the recorded candidates are not those that the episode's scenes and settings make.
    """
    follower = _Follower()
    started = episode.started if settings is None else dataclasses.replace(episode.started, settings=settings)
    replay = Replay(started, FeatureRecorder(follower, feature_set), is_strict=True)
    for event in episode.events:
        if isinstance(event, ActionChosen):
            follower.decision = event.weighed
        replay.play(event)
        if isinstance(event, ActionChosen) and event.turn <= episode.turns_over and replay.decision is not None:
            yield replay.decision


class _Follower:
    """Chooses what was chosen then."""

    selector = None

    def __init__(self) -> None:
        self.decision: Decision | None = None

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """Return the recorded choice.

        Raises:
            ReplayError: there were other candidates then.
        """
        if self.decision is None or self.decision.candidates != context.candidates:
            what = 'other candidates than the settings and scenes make were recorded'
            raise ReplayError(f'turn {context.turn}: {what}')
        return Choice(self.decision.chosen, self.decision.utilities)


def _world(members: Document, symbols: tuple[str, ...]) -> WorldSpec | UnknownWorld:
    """Return the simulated world, or why it is none: the document names a task and does not hold it."""
    name = members['task']
    try:
        dataset = Path(members['dataset']) if members['dataset'] else None
        world_spec = WorldSpec(load_task(name), members['seed'], members['sample'], dataset)
    except InputError as error:
        return UnknownWorld(name, str(error))
    if world_spec.task.symbols != symbols:
        return UnknownWorld(name, f'the task {name} that is known here has other symbols')
    return world_spec
