"""The teacher node: answers the learner's queries, from a script or by a person at this process's terminal.

mode:=scripted answers with the truth of the simulated world; mode:=terminal shows each question to you.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from al_questioner.domain import Answer, EpisodeError, InputError
from al_questioner.protocol.scripted_teacher import ScriptedTeacherMachine
from al_questioner.protocol.terminal_teacher import SAID, TerminalTeacherMachine
from al_questioner.questioning.dialogue import TeacherDialogue
from al_questioner.ros.machine_node import MachineNode
from al_questioner.ros.parameters import Value, declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, TEACHER_SETTINGS
from al_questioner.ros.terminal_thread import RunTerminal, TerminalThread, login_name
from al_questioner.ros.worlds import declare_world, world_members
from al_questioner.simulation import ScriptedTeacher, WorldSpec
from al_questioner.terminal.commands import WISHES
from al_questioner.terminal.run import run_terminal

LONGEST_NAME = 100


class TeacherNode(MachineNode):
    """Runs the machine of a teacher of the kind that the parameter `mode` asks for.

    Where that is a person, `run_terminal` lets them answer, in a thread of its own.
    """

    machine: ScriptedTeacherMachine | TerminalTeacherMachine

    def __init__(self, run_terminal: RunTerminal = run_terminal, **node_arguments: Any) -> None:
        super().__init__('teacher', **node_arguments)
        world = declare_world(self)
        given = declare(self, TEACHER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        mode, teacher_id = str(given['mode']), str(given['teacher_id'])
        if len(teacher_id) > LONGEST_NAME:
            raise InputError(f'parameter teacher_id: at most {LONGEST_NAME} characters, not {len(teacher_id)}')
        if given['wait_for_recorder']:
            self.await_recorder('answer')
        self._terminal: TerminalThread | None = None
        if mode == 'terminal':
            dialogue = TeacherDialogue(teacher_id or login_name(), self._send, other_words=WISHES)
            self.run(TerminalTeacherMachine(dialogue))
            self._terminal = TerminalThread(dialogue, run_terminal, self.context.try_shutdown)
        else:
            self.run(_script_of(world, given))

    @property
    def unacknowledged(self) -> Answer | None:
        """The answer that is on its way."""
        return self.machine.sender.unacknowledged

    @property
    def failure(self) -> Exception | None:
        """Error after which a person can answer no more."""
        return None if self._terminal is None else self._terminal.failure

    def destroy_node(self) -> None:
        """Give the terminal back, then stop."""
        if self._terminal is not None:
            self._terminal.close()
        super().destroy_node()

    def _send(self, episode_id: str, answer: Answer) -> None:
        self.enter(SAID, (episode_id, answer))


def _script_of(world: WorldSpec, given: Mapping[str, Value]) -> ScriptedTeacherMachine:
    truth = world.open().truth
    teacher = ScriptedTeacher(
        world.task.symbols,
        world.task.relevant_groups,
        world.seed,
        float(given['wrong_rate']),
        float(given['unknown_rate']),
        str(given['teacher_id']) or 'scripted',
        bool(given['repeat_shown']),
        float(given['relevance_omission']),
        float(given['relevance_false_alarm']),
    )
    # A copy has named nothing.
    return ScriptedTeacherMachine(
        partial(dataclasses.replace, teacher), truth, world_members(world), float(given['delay'])
    )


def main(arguments: Sequence[str]) -> int:
    """Run the node.

    Raises:
        InputError: a parameter that cannot be used.
        EpisodeError: the terminal could not be used any more.
    """
    node = spin_node(TeacherNode, arguments)
    if node is not None and node.failure is not None:
        raise EpisodeError(f'the terminal failed: {type(node.failure).__name__}: {node.failure}')
    return 0
