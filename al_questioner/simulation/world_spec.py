"""Specification of the world of an episode; naming a world imports neither the kitchen nor a dataset."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from al_questioner.domain import Setting
from al_questioner.simulation.task import Task

if TYPE_CHECKING:
    from al_questioner.simulation.world import World

TASK = Setting('task', 'kitchen_table', 'a name in config/tasks, or the path of a YAML file')
DATASET = Setting('dataset', '', 'root of a directory of RGB-D crops, for tasks that read one')
SEED = Setting('seed', 0, 'seed of everything that is drawn at random', lower=0)
SAMPLE = Setting(
    'sample', 0, 'sample of observations that the scenes are drawn from; unless set, that of the seed', lower=0
)


@dataclass(frozen=True)
class WorldSpec:
    """Specification of the world of an episode.

    Attributes:
        task: the task to learn, with the table of the sample if samples differ.
        seed: seed of the scenes.
        sample: number of the sample of observations that the scenes are drawn from.
        dataset: root of a directory of RGB-D crops, for tasks that read one.
    """

    task: Task
    seed: int
    sample: int
    dataset: Path | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, 'task', self.task.of_sample(self.sample))

    def open(self) -> World:
        """Return the world itself.

        Raises:
            InputError: the task needs a dataset that is not there, or cannot be read.
        """
        # Imported here, because drawing and reading pictures take long to import, and a learner needs neither.
        from al_questioner.simulation.world_factory import make_world

        return make_world(self.task, self.seed, self.sample, self.dataset)
