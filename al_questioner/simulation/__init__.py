"""Learning without a robot: tasks, worlds, a scripted teacher, whole episodes, and their evaluation.

A name is imported when it is first used.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.simulation.evaluation import EpisodeResult, Evaluation, accuracy
    from al_questioner.simulation.opening import make_world
    from al_questioner.simulation.perceived_world import PerceivedWorld
    from al_questioner.simulation.playing import TurnWatcher, play, run_episode, turns
    from al_questioner.simulation.rgbd_dataset.dataset import DatasetWorld
    from al_questioner.simulation.scripted_teacher import ScriptedTeacher
    from al_questioner.simulation.settings import episode_settings
    from al_questioner.simulation.simulated_world import SimulatedWorld
    from al_questioner.simulation.task import Task, load_task
    from al_questioner.simulation.task_reading import Interval
    from al_questioner.simulation.world import World
    from al_questioner.simulation.world_spec import WorldSpec

__all__ = [
    'DatasetWorld',
    'EpisodeResult',
    'Evaluation',
    'Interval',
    'PerceivedWorld',
    'ScriptedTeacher',
    'SimulatedWorld',
    'Task',
    'TurnWatcher',
    'World',
    'WorldSpec',
    'accuracy',
    'episode_settings',
    'load_task',
    'make_world',
    'play',
    'run_episode',
    'turns',
]

_HOMES = {
    'Task': 'task',
    'load_task': 'task',
    'Interval': 'task_reading',
    'SimulatedWorld': 'simulated_world',
    'World': 'world',
    'make_world': 'opening',
    'DatasetWorld': 'rgbd_dataset.dataset',
    'ScriptedTeacher': 'scripted_teacher',
    'EpisodeResult': 'evaluation',
    'Evaluation': 'evaluation',
    'PerceivedWorld': 'perceived_world',
    'TurnWatcher': 'playing',
    'WorldSpec': 'world_spec',
    'accuracy': 'evaluation',
    'episode_settings': 'settings',
    'play': 'playing',
    'run_episode': 'playing',
    'turns': 'playing',
}

__getattr__ = lazy_names(__name__, _HOMES)
