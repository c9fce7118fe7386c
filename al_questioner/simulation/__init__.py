"""Learning without a robot: tasks, worlds, a scripted teacher, whole episodes, and their evaluation.

A name is imported when it is first used.
"""

from typing import TYPE_CHECKING

from al_questioner.support.lazy_names import lazy_names

if TYPE_CHECKING:
    from al_questioner.simulation.evaluation import EpisodeResult as EpisodeResult
    from al_questioner.simulation.evaluation import Evaluation as Evaluation
    from al_questioner.simulation.evaluation import accuracy as accuracy
    from al_questioner.simulation.perceived_world import PerceivedWorld as PerceivedWorld
    from al_questioner.simulation.playing import TurnWatcher as TurnWatcher
    from al_questioner.simulation.playing import play as play
    from al_questioner.simulation.playing import run_episode as run_episode
    from al_questioner.simulation.playing import turns as turns
    from al_questioner.simulation.pool_world import Pool as Pool
    from al_questioner.simulation.pool_world import PoolWorld as PoolWorld
    from al_questioner.simulation.rgbd_dataset.dataset import DatasetWorld as DatasetWorld
    from al_questioner.simulation.scripted_teacher import ScriptedTeacher as ScriptedTeacher
    from al_questioner.simulation.settings import episode_settings as episode_settings
    from al_questioner.simulation.simulated_world import SimulatedWorld as SimulatedWorld
    from al_questioner.simulation.task import Task as Task
    from al_questioner.simulation.task import load_task as load_task
    from al_questioner.simulation.task_reading import Interval as Interval
    from al_questioner.simulation.world import SeenWorld as SeenWorld
    from al_questioner.simulation.world import World as World
    from al_questioner.simulation.world_factory import make_world as make_world
    from al_questioner.simulation.world_spec import WorldSpec as WorldSpec

__all__, __getattr__ = lazy_names(
    __name__,
    {
        'evaluation': ['EpisodeResult', 'Evaluation', 'accuracy'],
        'world_factory': ['make_world'],
        'perceived_world': ['PerceivedWorld'],
        'playing': ['TurnWatcher', 'play', 'run_episode', 'turns'],
        'pool_world': ['Pool', 'PoolWorld'],
        'rgbd_dataset.dataset': ['DatasetWorld'],
        'scripted_teacher': ['ScriptedTeacher'],
        'settings': ['episode_settings'],
        'simulated_world': ['SimulatedWorld'],
        'task': ['Task', 'load_task'],
        'task_reading': ['Interval'],
        'world': ['SeenWorld', 'World'],
        'world_spec': ['WorldSpec'],
    },
)
