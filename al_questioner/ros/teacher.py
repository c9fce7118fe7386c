"""The teacher node: answers the learner's queries from a script, with the truth of the simulated world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from al_questioner.domain import Answer, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.parameters import declare, help_text, refuse_unknown
from al_questioner.ros.running import run_nodes
from al_questioner.ros.settings import TEACHER_SETTINGS, WORLD_SETTINGS, all_names
from al_questioner.ros.worlds import check_world, declare_world
from al_questioner.teaching import ScriptedTeacher

RESEND_PERIOD = 1.0
"""Seconds after which an answer that was not acknowledged is sent again."""


class TeacherNode(QuestionerNode):
    """Answers every query once, and repeats the answer until the learner acknowledges it."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('teacher', **node_arguments)
        choice = self._choice = declare_world(self)
        given = declare(self, TEACHER_SETTINGS)
        refuse_unknown(self, all_names())
        if given['mode'] != 'scripted':
            raise InputError(f'parameter mode: unknown mode {given["mode"]!r}; known: scripted')
        self._world = choice.open()
        self._teacher = ScriptedTeacher(
            choice.task.symbols,
            choice.task.relevant_groups,
            choice.seed,
            float(given['wrong_rate']),
            float(given['unknown_rate']),
            str(given['teacher_id']),
        )
        self._delay = float(given['delay'])
        self._unacknowledged: Answer | None = None
        self._publish_answer = self.document_publisher('answer', qos.EVENTS)
        if given['wait_for_recorder']:
            self.await_recorder('answer')
        self.on_document('query', self._consider)
        self.on_document('answer_ack', self._acknowledged, qos.EVENTS)
        self.does('waiting for a query')

    def _consider(self, document: Document) -> None:
        check_world(document, self._choice)
        query = documents.query_of(document)
        self.episode_id = document['episode_id']
        answer = self._teacher.answer(query, self._world.truth(query.turn))
        self._unacknowledged = answer
        self.does(f'{query.query_id}: {query.text}')
        self.after(self._delay, lambda: self._send(answer))

    def _send(self, answer: Answer) -> None:
        if answer is self._unacknowledged:
            self._publish_answer(documents.answer_members(answer))
            self.after(RESEND_PERIOD, lambda: self._send(answer))

    def _acknowledged(self, document: Document) -> None:
        answer = self._unacknowledged
        if answer is None or document['episode_id'] != self.episode_id or document['answer_id'] != answer.answer_id:
            return
        self._unacknowledged = None
        self.does('waiting for a query')
        if not document['accepted']:
            raise InputError(f'the learner did not take the answer to {answer.query_id}: {document["reason"]}')


def main(arguments: Sequence[str]) -> int:
    """Run the node."""
    return run_nodes([TeacherNode], arguments, help_text(__doc__, (*WORLD_SETTINGS, *TEACHER_SETTINGS)))
