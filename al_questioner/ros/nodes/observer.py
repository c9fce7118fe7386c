"""A node that follows an episode from the outside."""

from __future__ import annotations

from typing import Any

from al_questioner.protocol.observer import ObserverMachine, StateWatcher
from al_questioner.ros.machine_node import MachineNode


class ObserverNode(MachineNode):
    """Runs an `ObserverMachine`.

    Args:
        episode_id: the episode to follow.
        watch: told of each state.
        patience: seconds without a state after which a warning on /diagnostics counts as the end.
        node_arguments: of the node.
    """

    machine: ObserverMachine

    def __init__(self, episode_id: str, watch: StateWatcher, patience: float, **node_arguments: Any) -> None:
        super().__init__('observer', **node_arguments)
        self.run(ObserverMachine(episode_id, watch, patience, self.get_namespace().strip('/')))
