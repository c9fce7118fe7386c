"""How an answer reaches the learner: said again and again until it is acknowledged."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.domain import Answer, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode

RESEND_PERIOD = 1.0
"""Seconds after which an answer that was not acknowledged is sent again."""


class Delivery:
    """Brings one answer at a time to the learner. All of it happens on the node's worker.

    Args:
        node: that speaks, of its present episode.
        acknowledged: told the answer and the learner's `answer_ack`.

    Attributes:
        unacknowledged: the answer that is on its way.
    """

    def __init__(self, node: QuestionerNode, acknowledged: Callable[[Answer, Document], None]) -> None:
        self.unacknowledged: Answer | None = None
        self._node = node
        self._tell = acknowledged
        self._publish = node.document_publisher('answer', qos.EVENTS)
        node.on_document('answer_ack', self._acknowledged, qos.EVENTS)

    def send(self, answer: Answer, delay: float = 0.0) -> None:
        """Send an answer after so many seconds, in the place of any that is still on its way."""
        self.unacknowledged = answer
        self._node.after(delay, lambda: self._repeat(answer))

    def drop(self) -> None:
        """Send the present answer no more."""
        self.unacknowledged = None

    def _repeat(self, answer: Answer) -> None:
        if answer is self.unacknowledged:
            self._publish(documents.answer_members(answer))
            self._node.after(RESEND_PERIOD, lambda: self._repeat(answer))

    def _acknowledged(self, document: Document) -> None:
        answer = self.unacknowledged
        if (
            answer is None
            or document['episode_id'] != self._node.episode_id
            or document['answer_id'] != answer.answer_id
        ):
            return
        self.unacknowledged = None
        self._tell(answer, document)
        if not document['accepted']:
            raise InputError(f'the learner did not take the answer to {answer.query_id}: {document["reason"]}')
