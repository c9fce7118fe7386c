"""The teacher node: answers the learner's queries, from a script or by a person at this process's terminal.

mode:=scripted answers with the truth of the simulated world; mode:=terminal shows each question to you.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any

from al_questioner.domain import Answer, EpisodeError, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros.answer_sender import AnswerSender
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.nodes.terminal_teacher import RunTerminal, TerminalTeacher, login_name
from al_questioner.ros.parameters import Value, declare, reject_unknown
from al_questioner.ros.running import spin_node
from al_questioner.ros.settings import ALL_NAMES, TEACHER_SETTINGS
from al_questioner.ros.worlds import check_world, declare_world
from al_questioner.simulation import ScriptedTeacher, WorldSpec
from al_questioner.terminal.run import run_terminal

LONGEST_NAME = 100


class TeacherNode(QuestionerNode):
    """Answers every query once, and repeats the answer until the learner acknowledges it.

    Where the parameter `mode` says so, `run_terminal` lets a person answer.
    """

    def __init__(self, run_terminal: RunTerminal = run_terminal, **node_arguments: Any) -> None:
        super().__init__('teacher', **node_arguments)
        world_spec = declare_world(self)
        given = declare(self, TEACHER_SETTINGS)
        reject_unknown(self, ALL_NAMES)
        mode, teacher_id = str(given['mode']), str(given['teacher_id'])
        if len(teacher_id) > LONGEST_NAME:
            raise InputError(f'parameter teacher_id: at most {LONGEST_NAME} characters, not {len(teacher_id)}')
        if given['wait_for_recorder']:
            self.await_recorder('answer')
        self._teacher: _Script | TerminalTeacher
        if mode == 'terminal':
            self._teacher = TerminalTeacher(self, teacher_id or login_name(), run_terminal)
        else:
            self._teacher = _Script(self, world_spec, given)

    @property
    def unacknowledged(self) -> Answer | None:
        """The answer that is on its way."""
        return self._teacher.sender.unacknowledged

    @property
    def failure(self) -> Exception | None:
        """Error after which a person can answer no more."""
        return self._teacher.failure

    def destroy_node(self) -> None:
        """Give the terminal back, then stop."""
        self._teacher.close()
        super().destroy_node()


class _Script:
    """Answers from the truth of a world of its own."""

    failure = None

    def __init__(self, node: QuestionerNode, world_spec: WorldSpec, given: Mapping[str, Value]) -> None:
        self._node = node
        self._world_spec = world_spec
        self._world = world_spec.open()
        self._teacher = ScriptedTeacher(
            world_spec.task.symbols,
            world_spec.task.relevant_groups,
            world_spec.seed,
            float(given['wrong_rate']),
            float(given['unknown_rate']),
            str(given['teacher_id']) or 'scripted',
            bool(given['repeat_shown']),
            float(given['relevance_omission']),
            float(given['relevance_false_alarm']),
        )
        self._delay = float(given['delay'])
        self.sender = AnswerSender(node, self._acknowledged)
        node.on_document('query', self._consider)
        node.set_status('waiting for a query', awaited='query')

    def close(self) -> None:
        """Nothing is held."""

    def _consider(self, document: Document) -> None:
        check_world(document, self._world_spec)
        query = documents.query_of(document)
        if document['episode_id'] != self._node.episode_id:
            self._node.episode_id = document['episode_id']
            # What was named in another episode is nothing that this learner knows.
            self._teacher = dataclasses.replace(self._teacher)
        answer = self._teacher.answer(query, self._world.truth(query.turn))
        self._node.set_status(f'{query.query_id}: {query.text}')
        self.sender.send(answer, self._delay)

    def _acknowledged(self, _: Answer, __: Document) -> None:
        self._node.set_status('waiting for a query', awaited='query')


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
