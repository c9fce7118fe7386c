"""A node that follows an episode from the outside."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus

from al_questioner.domain import EpisodeError, QueryRecord
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode

StateWatcher = Callable[[int, tuple[QueryRecord, ...]], None]
"""Called with the turn that has ended and all queries so far."""


class ObserverNode(QuestionerNode):
    """Hands every `learner_state` of one episode on, and notices when nothing goes on any more.

    A state that is missed matters not, since the next holds all that came before.

    Args:
        episode_id: the episode to follow.
        watch: told of each state.
        patience: seconds without a state after which a warning on /diagnostics counts as the end.
    """

    def __init__(self, episode_id: str, watch: StateWatcher, patience: float, **node_arguments: Any) -> None:
        super().__init__('observer', **node_arguments)
        self.episode_id = episode_id
        self.done = False
        self.failure: BaseException | None = None
        self._watch = watch
        self._patience = patience
        self._last_progress = time.monotonic()
        self.on_document('learner_state', self._follow)
        self.on_message(DiagnosticArray, '/diagnostics', self._examine, qos.DIAGNOSTICS)
        self.set_status('watching the learner')

    def _follow(self, document: Document) -> None:
        if self.done or document['episode_id'] != self.episode_id:
            return
        self._last_progress = time.monotonic()
        try:
            self._watch(document['turn'], tuple(documents.record_of(record) for record in document['queries']))
        except (Exception, SystemExit) as error:
            # SystemExit is how rich ends a program whose output nobody reads any more.
            self.failure = error
            raise
        self.done = document['done']

    def _examine(self, array: DiagnosticArray) -> None:
        """Take an error of a node of this graph for the end, and a warning when nothing has happened for long."""
        for status in array.status:
            ours = status.name.startswith(self.get_namespace().strip('/') + '/')
            stalled = time.monotonic() - self._last_progress > self._patience
            failed = status.level == DiagnosticStatus.ERROR
            if ours and (failed or (stalled and status.level == DiagnosticStatus.WARN)):
                self.failure = EpisodeError(f'{status.name}: {status.message}')
