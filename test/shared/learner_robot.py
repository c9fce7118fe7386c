"""A learner's machine, with what surrounds it as a test has it."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from al_questioner.domain import EpisodeSettings, Scene
from al_questioner.event_log.log import SessionLog
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.effects import Effect, Publish
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.protocol.topics import Look
from al_questioner.questioning import Picker
from al_questioner.simulation import PerceivedWorld
from shared.durable_sessions import WORLD, durable_of, episode_started
from shared.lunches import teacher
from shared.machine_driver import Driver


class Robot:
    """A learner, with what surrounds it as the test has it."""

    def __init__(
        self,
        world: PerceivedWorld,
        folder: Path | None,
        settings: EpisodeSettings,
        options: LearnerOptions,
        pick: Picker | None = None,
        do: Callable[[Effect], None] = lambda _: None,
    ) -> None:
        started = episode_started(settings=settings)
        durable = durable_of(started, None if folder is None else SessionLog(folder), pick)
        self.driver = Driver(LearnerMachine(durable, WORLD, options), do)
        self.machine = self.driver.machine
        self.durable = durable
        self._world = world

    def sees(self, stamp: int | None = None, scene: Scene | None = None) -> None:
        """Show the scene of the turn that was begun last, under its stamp unless another is given."""
        turn = self.said('turn')[-1]
        shown = self._world.scene(turn['turn']) if scene is None else scene
        self.driver.hear('objects', Look(stamp_of(turn['stamp']) if stamp is None else stamp, 'table', lambda _: shown))

    def is_taught(self) -> Document:
        """Answer the question that was asked last, and return the answer."""
        query = documents.query_of(self.said('query')[-1])
        answer = documents.answer_members(teacher().answer(query, self._world.truth(query.turn)))
        self.driver.hear_document('answer', 'e1', answer)
        return answer

    def says(self, text: str) -> Document:
        """Say a text to it, and return the acknowledgement."""
        before = len(self.said('answer_ack'))
        self.driver.hear('answer', text)
        (ack,) = self.said('answer_ack')[before:]
        return ack

    def answers(self, query: Document, content: object, **changes: object) -> Document:
        """Answer by a document, and return the acknowledgement."""
        return self.says(answer_text(query, content, **changes))

    def plays(self) -> list[Document]:
        """Have the episode played to its end by a teacher who never errs, and return the queries of its last state."""
        while not self.durable.episode.done:
            self.sees()
            if self.durable.episode.awaits_answer:
                self.is_taught()
        return self.said('learner_state')[-1]['queries']

    def said(self, topic: str) -> list[Any]:
        """Return all that was said on a topic."""
        return self.driver.published(topic)

    @property
    def order(self) -> list[str]:
        """Topics of all that was said, in order."""
        return [effect.topic for effect in self.driver.effects(Publish)]


def answer_text(query: Document, content: object, **changes: object) -> str:
    """The document of an answer."""
    document = {
        'schema': 'al_questioner/answer/1', 'episode_id': query['episode_id'], 'query_id': query['query_id'],
        'answer_id': 'a1', 'teacher_id': 'anna', 'outcome': 'answered', 'content': content,
    }  # fmt: skip
    return json.dumps(document | changes)
