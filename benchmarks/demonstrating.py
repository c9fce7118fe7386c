"""Demonstrations that nobody recorded: those of a strategy that is played offline."""

from __future__ import annotations

from al_questioner.domain import EpisodeSettings, random_stream
from al_questioner.imitation.demonstration import Demonstration, steps_of
from al_questioner.questioning import FEATURE_SETS, Episode, FeatureRecorder, FeatureSet, make_strategy
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, turns


def demonstrate(
    world_spec: WorldSpec,
    settings: EpisodeSettings,
    teacher: ScriptedTeacher,
    world: PerceivedWorld | None = None,
    feature_set: FeatureSet = FEATURE_SETS['dt_task_env'],
) -> Demonstration:
    """Play a demonstration by the strategy of the settings, offline; the seed of the world is the questioner's too.

    Raises:
        SettingsError: an unknown strategy, or weights that do not fit it.
    """
    seen = PerceivedWorld(world_spec.open()) if world is None else world
    expert = FeatureRecorder(make_strategy(settings.strategy, settings.weights), feature_set)
    episode = Episode(settings, random_stream(world_spec.seed, 'learner'), strategy=expert)
    steps = steps_of((decision for decision, _ in turns(episode, seen, teacher)), feature_set.passed_over)
    return Demonstration(
        name=f'{settings.strategy} {world_spec.task.name} {world_spec.seed}',
        settings=settings,
        world=world_spec,
        turns=settings.turns,
        steps=steps,
        feature_names=seen.scene(1).feature_names,
        queries=episode.records,
        change_turns=tuple(seen.change_turns(settings.turns)),
        feature_set=feature_set,
    )
