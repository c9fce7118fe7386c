"""A node that follows an episode from the outside."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from al_questioner.domain import QueryRecord
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros.node import QuestionerNode

StateWatcher = Callable[[int, tuple[QueryRecord, ...]], None]
"""Called with the turn that has ended and all queries so far."""


class ObserverNode(QuestionerNode):
    """Hands every `learner_state` on; one that is missed matters not, since the next holds all that came before."""

    def __init__(self, watch: StateWatcher, **node_arguments: Any) -> None:
        super().__init__('observer', **node_arguments)
        self._watch = watch
        self.done = False
        self.failure: Exception | None = None
        self.on_document('learner_state', self._follow)
        self.does('watching the learner')

    def _follow(self, document: Document) -> None:
        if self.done:
            return
        try:
            self._watch(document['turn'], tuple(documents.record_of(record) for record in document['queries']))
        except Exception as error:
            self.failure = error
            raise
        self.done = document['done']
