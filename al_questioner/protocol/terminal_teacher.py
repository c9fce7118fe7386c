"""Machine of a teacher whose answers a person gives at this process."""

from __future__ import annotations

from al_questioner.domain import Answer
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.answer_sender import AWAITING, AnswerSender
from al_questioner.protocol.effects import Effects, Report
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import Look, PictureShown
from al_questioner.questioning.dialogue import EpisodeProgress, TeacherDialogue

SAID = 'said'
"""Source of the answers of the person; the content is the id of the episode, and the answer."""


class TerminalTeacherMachine(Machine):
    """Hands what the robot says to a dialogue, and what the person says to the robot.

    Args:
        dialogue: what is asked and said. Whatever it sends is to be entered as `SAID`.

    Attributes:
        sender: of the answers.
    """

    publishes = ('answer',)

    def __init__(self, dialogue: TeacherDialogue) -> None:
        super().__init__()
        self._dialogue = dialogue
        self._feature_names: tuple[str, ...] = ()
        self.sender = AnswerSender(self, self._acknowledged)
        self.on_document('episode', self._begin)
        self.on_document('learner_state', self._follow)
        self.on_document('query', self._ask)
        self.on('objects', self._look)
        self.on('scene_image', self._see)
        self.on_entry(SAID, self._say)

    def start(self) -> Effects:
        """Say what it waits for."""
        yield AWAITING

    def _enter(self, document: Document) -> Effects:
        if document['episode_id'] != self.episode_id:
            self.episode_id = document['episode_id']
            yield from self.sender.drop()
        self._dialogue.enter(document['episode_id'])

    def _begin(self, document: Document) -> Effects:
        yield from self._enter(document)
        self._dialogue.begin(document['turns'], float(document['budget']))

    def _follow(self, document: Document) -> Effects:
        if document['done'] and self.episode_id not in ('', document['episode_id']):
            # Of a learner that is over and has not yet noticed that another one has begun.
            return
        yield from self._enter(document)
        last = document.get('last_answer')
        self._dialogue.follow(
            EpisodeProgress(
                document['turn'],
                document['turns'],
                float(document['budget']),
                float(document['spent']),
                document['done'],
                tuple(documents.record_of(record) for record in document['queries']),
                last and (documents.query_of(last['query']), documents.answer_of(last['answer'])),
            )
        )

    def _ask(self, document: Document) -> Effects:
        query = documents.query_of(document)
        yield from self._enter(document)
        self._dialogue.ask(query)
        yield Report(f'{query.query_id}: {query.text}')

    def _look(self, look: Look) -> Effects:
        scene = look.read(self._feature_names)
        self._feature_names = scene.feature_names
        self._dialogue.look(scene, look.stamp)
        yield from ()

    def _see(self, shown: PictureShown) -> Effects:
        self._dialogue.see(shown.picture, shown.stamp)
        yield from ()

    def _say(self, said: tuple[str, Answer]) -> Effects:
        episode_id, answer = said
        # The answer to a question of an episode that has been left meanwhile is none to the new one's.
        if episode_id == self.episode_id:
            yield from self.sender.send(answer)

    def _acknowledged(self, answer: Answer, document: Document) -> Effects:
        yield AWAITING
        self._dialogue.acknowledge(answer.answer_id, document['accepted'], document['reason'])
