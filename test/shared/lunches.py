"""One small world of a lunch, and its teacher, for tests of whole episodes without ROS."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

from al_questioner.domain import Knowledge, Scene, random_stream
from al_questioner.questioning import Episode
from al_questioner.simulation import (
    PerceivedWorld,
    ScriptedTeacher,
    Task,
    WorldSpec,
    episode_settings,
    load_task,
    turns,
)

TASK = load_task('prepare_lunch')
WORLD_SPEC = WorldSpec(TASK, 4, 4)


def teacher_of(task: Task, seed: int, **options: float | bool) -> ScriptedTeacher:
    """The scripted teacher of a task."""
    return ScriptedTeacher(task.symbols, task.relevant_groups, seed, **options)


def teacher(**options: float | bool) -> ScriptedTeacher:
    """The teacher of that world."""
    return teacher_of(TASK, 4, **options)


class Taught(NamedTuple):
    """Knowledge of a learner after an episode, and the last scene that it saw."""

    knowledge: Knowledge
    scene: Scene
    symbols: tuple[str, ...]


@cache
def taught() -> Taught:
    """Return what a learner knows after an episode in that world."""
    episode = Episode(episode_settings(TASK, 'farthest_fsq', 10.0, 12), random_stream(4, 'learner'))
    world = PerceivedWorld(WORLD_SPEC.open())
    for _ in turns(episode, world, teacher()):
        pass
    return Taught(episode.knowledge('lunch'), world.scene(12), TASK.symbols)
