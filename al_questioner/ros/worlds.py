"""Parameters of the simulated world, which perception, learner and teacher must share."""

from __future__ import annotations

import dataclasses
import uuid
from pathlib import Path

from rclpy.node import Node

from al_questioner.messages.documents import Document
from al_questioner.ros.parameters import declare
from al_questioner.simulation import WorldSpec, load_task
from al_questioner.simulation.world_spec import DATASET, SAMPLE, SEED, TASK


def declare_world(node: Node) -> WorldSpec:
    """Declare the parameters `task`, `dataset`, `seed` and `sample`, and read them.

    Raises:
        InputError: an unknown task, or a value out of range.
    """
    given = declare(node, (TASK, DATASET, SEED))
    seed = int(given['seed'])
    sample = declare(node, [dataclasses.replace(SAMPLE, default=seed)])
    dataset = Path(str(given['dataset'])).expanduser() if given['dataset'] else None
    return WorldSpec(load_task(str(given['task'])), seed, int(sample['sample']), dataset)


def new_episode_id(world: WorldSpec) -> str:
    """Make an id that no other episode has."""
    return f'{world.task.name}-{world.seed}-{uuid.uuid4().hex[:8]}'


def world_members(world: WorldSpec) -> Document:
    """Return the `world` member of the documents `episode` and `turn`."""
    return {
        'task': world.task.name,
        'seed': world.seed,
        'sample': world.sample,
        'dataset': None if world.dataset is None else str(world.dataset),
    }
