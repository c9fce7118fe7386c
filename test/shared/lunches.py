"""One small world of a lunch, and its teacher, for tests of whole episodes without ROS."""

from __future__ import annotations

from al_questioner.simulation import ScriptedTeacher, Task, WorldSpec, load_task

TASK = load_task('prepare_lunch')
WORLD_SPEC = WorldSpec(TASK, 4, 4)


def teacher_of(task: Task, seed: int, **options: float | bool) -> ScriptedTeacher:
    """The scripted teacher of a task."""
    return ScriptedTeacher(task.symbols, task.relevant_groups, seed, **options)


def teacher(**options: float | bool) -> ScriptedTeacher:
    """The teacher of that world."""
    return teacher_of(TASK, 4, **options)
