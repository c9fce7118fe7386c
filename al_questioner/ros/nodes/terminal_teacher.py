"""Between the topics and a person at the terminal of this process."""

from __future__ import annotations

import getpass
import threading
from collections.abc import Callable
from typing import Any

from sensor_msgs.msg import Image, PointCloud2

from al_questioner.domain import Answer
from al_questioner.messages import documents
from al_questioner.messages.clouds import scene_of_cloud
from al_questioner.messages.documents import Document
from al_questioner.messages.pictures import picture_of_image
from al_questioner.messages.stamps import nanoseconds
from al_questioner.questioning.dialogue.teacher_dialogue import TeacherDialogue
from al_questioner.questioning.dialogue.view_state import EpisodeProgress
from al_questioner.ros import qos
from al_questioner.ros.answer_sender import AnswerSender
from al_questioner.ros.node import QuestionerNode

SECONDS_TO_CLOSE = 5.0
"""Seconds within which the screen is closed."""

RunTerminal = Callable[[TeacherDialogue, threading.Event], Any]
"""Shows a dialogue to a person and has them answer, until they have done or the event is set."""


def login_name() -> str:
    """Return the name of the person who is logged in, the teacher if nobody says otherwise."""
    try:
        return getpass.getuser() or 'human'
    except (KeyError, OSError, ImportError):
        # A user without an entry in the password database, as in containers.
        return 'human'


class TerminalTeacher:
    """Hands what the robot says to a dialogue, and what the person says to the robot.

    `run_terminal` attends to the person in a thread of its own, which ends the node's context when they have done.

    Attributes:
        dialogue: what is asked and said.
        failure: why the thread ended before its time.
    """

    def __init__(self, node: QuestionerNode, teacher_id: str, run_terminal: RunTerminal) -> None:
        self.dialogue = TeacherDialogue(teacher_id, self._say)
        self.failure: Exception | None = None
        self._node = node
        self._attend = run_terminal
        self._stopped = threading.Event()
        self._feature_names: tuple[str, ...] = ()
        self.sender = AnswerSender(node, self._acknowledged)
        node.on_document('episode', self._begin)
        node.on_document('learner_state', self._follow)
        node.on_document('query', self._ask)
        node.on_message(PointCloud2, 'objects', self._look, qos.LATCHED)
        node.on_message(Image, 'scene_image', self._see, qos.LATCHED)
        node.set_status('waiting for a query', awaited='query')
        self._thread = threading.Thread(target=self._run, name='terminal', daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Give the terminal back."""
        self._stopped.set()
        self.dialogue.wake()
        if self._thread is not threading.current_thread():
            self._thread.join(SECONDS_TO_CLOSE)

    def _run(self) -> None:
        try:
            self._attend(self.dialogue, self._stopped)
        except Exception as error:  # noqa: BLE001 - whatever it is, the process must end and say so
            self.failure = error
        finally:
            if not self._stopped.is_set():
                self._node.context.try_shutdown()

    def _enter(self, document: Document) -> None:
        if document['episode_id'] != self._node.episode_id:
            self._node.episode_id = document['episode_id']
            self.sender.drop()
        self.dialogue.enter(document['episode_id'])

    def _begin(self, document: Document) -> None:
        self._enter(document)
        self.dialogue.begin(document['turns'], float(document['budget']))

    def _follow(self, document: Document) -> None:
        if document['done'] and self._node.episode_id not in ('', document['episode_id']):
            # Of a learner that is over and has not yet noticed that another one has begun.
            return
        self._enter(document)
        last = document.get('last_answer')
        self.dialogue.follow(
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

    def _ask(self, document: Document) -> None:
        query = documents.query_of(document)
        self._enter(document)
        self.dialogue.ask(query)
        self._node.set_status(f'{query.query_id}: {query.text}')

    def _look(self, cloud: PointCloud2) -> None:
        scene = scene_of_cloud(cloud, self._feature_names)
        self._feature_names = scene.feature_names
        self.dialogue.look(scene, nanoseconds(cloud.header.stamp))

    def _see(self, image: Image) -> None:
        self.dialogue.see(picture_of_image(image), nanoseconds(image.header.stamp))

    def _say(self, episode_id: str, answer: Answer) -> None:
        def send() -> None:
            # The answer to a question of an episode that has been left meanwhile is none to the new one's.
            if episode_id == self._node.episode_id:
                self.sender.send(answer)

        self._node.submit(send)

    def _acknowledged(self, answer: Answer, document: Document) -> None:
        self._node.set_status('waiting for a query', awaited='query')
        self.dialogue.acknowledge(answer.answer_id, document['accepted'], document['reason'])
