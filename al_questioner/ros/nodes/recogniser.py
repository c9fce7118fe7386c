"""The recogniser node: tells what the things in view are taken for, and where the wanted one is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from al_questioner.domain import InputError
from al_questioner.event_log.log import read_log
from al_questioner.event_log.summary import summarise_session
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.protocol.recogniser import Known, RecogniserMachine
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.parameters import Value, declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, RECOGNISER_SETTINGS


class RecogniserNode(MachineNode):
    """Runs a `RecogniserMachine` with what the parameters name; while it learns, the newest cloud waits."""

    machine: RecogniserMachine

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('recogniser', **node_arguments)
        given = declare(self, RECOGNISER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        # What cannot be used is to be said before anything is published.
        known = known_already(given)
        self.run(RecogniserMachine(float(given['threshold']), known))


def known_already(given: Mapping[str, Value]) -> Known | None:
    """Return what is known by the parameters; None if that is left to a learner.

    Raises:
        InputError: it cannot be used, or both a file and a session are named.
    """
    file, folder = str(given['concepts']), str(given['session'])
    if file and folder:
        raise InputError('give one of the parameters concepts and session, not both')
    if file:
        return Known(read_concepts(Path(file).expanduser()), file)
    if folder:
        path = Path(folder).expanduser()
        summary = summarise_session(path, read_log(path))
        return Known(summary.knowledge, folder, summary.fault or '')
    return None


def main(arguments: Sequence[str]) -> int:
    """Run the node."""
    spin_node(RecogniserNode, arguments)
    return 0
