"""Sending of answers to the learner, each repeated until the learner acknowledges it."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.domain import Answer, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.retransmitter import PERSISTENT, Retransmitter


class AnswerSender:
    """Sender of one answer at a time to the learner. All methods run on the node's worker."""

    def __init__(self, node: QuestionerNode, acknowledged: Callable[[Answer, Document], None]) -> None:
        self._node = node
        self._tell = acknowledged
        publish = node.document_publisher('answer', qos.EVENTS)
        self._retransmitter = Retransmitter[Answer](
            node.after, lambda answer: publish(documents.answer_members(answer)), PERSISTENT
        )
        node.on_document('answer_ack', self._acknowledged, qos.EVENTS)

    @property
    def unacknowledged(self) -> Answer | None:
        """Answer that is sent and not acknowledged yet; None if there is none."""
        return self._retransmitter.message

    def send(self, answer: Answer, delay: float = 0.0) -> None:
        """Send an answer after a delay in seconds, in place of any other that is not acknowledged yet.

        If this answer is being sent already, nothing changes, so that a repeated question does not delay it.
        """
        if answer != self.unacknowledged:
            self._retransmitter.send(answer, delay)

    def drop(self) -> None:
        """Stop sending the present answer."""
        self._retransmitter.stop()

    def _acknowledged(self, document: Document) -> None:
        answer = self.unacknowledged
        if (
            answer is None
            or document['episode_id'] != self._node.episode_id
            or document['answer_id'] != answer.answer_id
        ):
            return
        self.drop()
        self._tell(answer, document)
        if not document['accepted']:
            raise InputError(f'the learner did not accept the answer to {answer.query_id}: {document["reason"]}')
