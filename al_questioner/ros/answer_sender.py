"""How an answer reaches the learner: said again and again until it is acknowledged."""

from __future__ import annotations

from collections.abc import Callable

from al_questioner.domain import Answer, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.retransmitter import PERSISTENT, Retransmitter


class AnswerSender:
    """Brings one answer at a time to the learner. All of it happens on the node's worker.

    Args:
        node: that speaks, of its present episode.
        acknowledged: told the answer and the learner's `answer_ack`.
    """

    def __init__(self, node: QuestionerNode, acknowledged: Callable[[Answer, Document], None]) -> None:
        self._node = node
        self._tell = acknowledged
        publish = node.document_publisher('answer', qos.EVENTS)
        self._mouth = Retransmitter[Answer](
            node.after, lambda answer: publish(documents.answer_members(answer)), PERSISTENT
        )
        node.on_document('answer_ack', self._acknowledged, qos.EVENTS)

    @property
    def unacknowledged(self) -> Answer | None:
        """The answer that is on its way."""
        return self._mouth.said

    def send(self, answer: Answer, delay: float = 0.0) -> None:
        """Send an answer after so many seconds, in the place of any other that is still on its way.

        Of one that is on its way already nothing changes: a question that is heard twice is answered no later.
        """
        if answer != self.unacknowledged:
            self._mouth.say(answer, delay)

    def drop(self) -> None:
        """Send the present answer no more."""
        self._mouth.stop()

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
            raise InputError(f'the learner did not take the answer to {answer.query_id}: {document["reason"]}')
