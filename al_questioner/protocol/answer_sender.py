"""Sending of answers to the learner, each repeated until the learner acknowledges it."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.domain import Answer
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.effects import Effects, Refuse, Report
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.retransmitter import PERSISTENT, Retransmitter

AWAITING = Report('waiting for a query', awaited='query')
"""Activity of a teacher that has nothing to answer."""


class AnswerSender:
    """Part of a teacher's machine: sends one answer at a time to the learner.

    Args:
        machine: whose part it is.
        acknowledged: does what follows the acknowledgement of an answer.

    Attributes:
        unacknowledged: the answer that is sent and not acknowledged yet; None if there is none.
    """

    def __init__(self, machine: Machine, acknowledged: Callable[[Answer, Document], Effects]) -> None:
        self.unacknowledged: Answer | None = None
        self._machine = machine
        self._follow = acknowledged
        self._retransmitter = Retransmitter(machine, 'answer', PERSISTENT)
        machine.on_document('answer_ack', self._acknowledged)

    def send(self, answer: Answer, delay: float = 0.0) -> Effects:
        """Send an answer after a delay in seconds, in place of any other that is not acknowledged yet.

        If this answer is being sent already, nothing changes, so that a repeated question does not delay it.
        """
        if answer != self.unacknowledged:
            self.unacknowledged = answer
            message = self._machine.document('answer', documents.answer_members(answer))
            yield from self._retransmitter.send(message, delay)

    def drop(self) -> Effects:
        """Stop sending the present answer."""
        self.unacknowledged = None
        yield from self._retransmitter.stop()

    def _acknowledged(self, document: Document) -> Effects:
        answer = self.unacknowledged
        if (
            answer is None
            or document['episode_id'] != self._machine.episode_id
            or document['answer_id'] != answer.answer_id
        ):
            return
        yield from self.drop()
        yield from self._follow(answer, document)
        if not document['accepted']:
            reason = f'the learner did not accept the answer to {answer.query_id}: {document["reason"]}'
            yield Refuse('answer_ack', reason)
