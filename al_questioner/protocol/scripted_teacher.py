"""Machine of a teacher who answers from a script that knows the truth."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from al_questioner.domain import Answer
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.answer_sender import AWAITING, AnswerSender
from al_questioner.protocol.effects import Effects, Report
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.worlds import check_world
from al_questioner.questioning import Teacher


class ScriptedTeacherMachine(Machine):
    """Answers every query once, and repeats the answer until the learner acknowledges it.

    Args:
        new_teacher: makes a teacher who has named nothing yet. Each episode has one of its own, since what was named
            in another is nothing that its learner knows.
        truth: returns the symbol by object id of a turn.
        world: the world of the truth, as documents have it.
        delay: seconds from a query to its answer.

    Attributes:
        sender: of the answers.
    """

    publishes = ('answer',)

    def __init__(
        self,
        new_teacher: Callable[[], Teacher],
        truth: Callable[[int], Mapping[int, str]],
        world: Document,
        delay: float = 0.0,
    ) -> None:
        super().__init__()
        self._new_teacher = new_teacher
        self._teacher = new_teacher()
        self._truth = truth
        self._world = world
        self._delay = delay
        self.sender = AnswerSender(self, self._acknowledged)
        self.on_document('query', self._consider)

    def start(self) -> Effects:
        """Say what it waits for."""
        yield AWAITING

    def _consider(self, document: Document) -> Effects:
        check_world(document, self._world)
        query = documents.query_of(document)
        if document['episode_id'] != self.episode_id:
            self.episode_id = document['episode_id']
            self._teacher = self._new_teacher()
            # The same answer to the same question of another episode is another message.
            yield from self.sender.drop()
        answer = self._teacher.answer(query, self._truth(query.turn))
        yield Report(f'{query.query_id}: {query.text}')
        yield from self.sender.send(answer, self._delay)

    def _acknowledged(self, _: Answer, __: Document) -> Effects:
        yield AWAITING
