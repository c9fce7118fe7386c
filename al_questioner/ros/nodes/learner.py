"""The learner node: an episode between the topics of the robot and of the teacher."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from al_questioner.concepts import compile_models
from al_questioner.event_log.storage import SqliteStorage, StorageFactory
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.questioning import make_strategy
from al_questioner.ros.learner_episode import (
    concepts_files,
    durable_episode_of,
    known_concepts,
    notes_on_known,
    settings_of,
)
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.parameters import declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, CONCEPTS, learner_settings
from al_questioner.ros.worlds import declare_world, world_members
from al_questioner.terminal.menu import make_picker


class LearnerNode(MachineNode):
    """Runs a `LearnerMachine` with the episode that the parameters ask for.

    Args:
        yields: end the node's context when the episode is over and another learner begins one on the same topics.
        storage: writes the session, if there is one.
        node_arguments: of the node.
    """

    def __init__(self, yields: bool = False, storage: StorageFactory = SqliteStorage, **node_arguments: Any) -> None:
        super().__init__('learner', **node_arguments)
        world = declare_world(self)
        file = declare(self, [CONCEPTS])
        known = known_concepts(file)
        others = [each for each in learner_settings(world.task, known) if each.name not in file]
        given = file | declare(self, others)
        settings = settings_of(world.task, given, known)
        # What cannot be used is to be said before anything is published, and before a log is begun.
        strategy = make_strategy(settings.strategy, settings.weights, make_picker())
        reject_unknown(self, ALL_NAMES)
        options = LearnerOptions(
            float(given['turn_period']),
            float(given['answer_timeout']),
            yields,
            concepts_files(given),
            notes_on_known(settings),
            str(given['session']),
        )
        durable = durable_episode_of(settings, strategy, world, given, storage)
        self.set_status('preparing the models; where they have to be compiled first, that takes some ten seconds')
        self.submit(compile_models)
        if given['wait_for_recorder']:
            self.await_recorder('episode', 'turn', 'query', 'answer_ack', 'decision', 'learner_state')
        self.run(LearnerMachine(durable, world_members(world), options))


def main(arguments: Sequence[str], storage: StorageFactory = SqliteStorage) -> int:
    """Run the node."""
    spin_node(partial(LearnerNode, yields=True, storage=storage), arguments)
    return 0
