"""Opening of the world that a task needs."""

from __future__ import annotations

from pathlib import Path

from al_questioner.domain import InputError
from al_questioner.simulation.rgbd_dataset.dataset import DatasetWorld
from al_questioner.simulation.simulated_world import SimulatedWorld
from al_questioner.simulation.task import Task
from al_questioner.simulation.world import World


def make_world(task: Task, seed: int, sample: int | None = None, dataset: Path | None = None) -> World:
    """Return the world of a task, with scenes of this seed.

    Training pool and test set are of the sample, None for that of the seed. A dataset has the layout of the University
    of Washington RGB-D Object Dataset.

    Raises:
        InputError: a dataset task without a dataset, a simulated task with one, an unusable dataset, or a task of
            arrays, which does not hold them.
    """
    if task.source == 'arrays':
        raise InputError(f'the things of task {task.name} are arrays in a program: its world must be given')
    if task.source == 'simulated':
        if dataset is not None:
            raise InputError(f'task {task.name} is simulated: it takes no dataset')
        return SimulatedWorld(task, seed, sample)
    if dataset is None:
        raise InputError(
            f'task {task.name} needs a dataset: give its directory (--dataset DIR, or the parameter dataset)'
        )
    return DatasetWorld(task, Path(dataset), seed, sample)
