"""Machine that follows an episode from the outside."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from al_questioner.domain import EpisodeError, QueryRecord
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.effects import Effects, Report
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import Health, Status

StateWatcher = Callable[[int, tuple[QueryRecord, ...]], None]
"""Called with the turn that has ended and all queries so far."""


class ObserverMachine(Machine):
    """Hands every `learner_state` of one episode on, and notices when nothing goes on any more.

    It does no harm to miss a state, since the next one holds all that came before.

    Args:
        episode_id: the episode to follow.
        watch: told of each state.
        patience: seconds without a state after which a warning on /diagnostics counts as the end.
        namespace: of the nodes whose statuses count, without a slash at either end.

    Attributes:
        done: whether the episode is over.
        failure: what has ended it before its time.
    """

    def __init__(self, episode_id: str, watch: StateWatcher, patience: float, namespace: str) -> None:
        super().__init__(episode_id)
        self.done = False
        self.failure: BaseException | None = None
        self._watch = watch
        self._patience = patience
        self._namespace = namespace
        self._last_progress = math.inf
        self.on_document('learner_state', self._follow)
        self.on('/diagnostics', self._examine)

    def start(self) -> Effects:
        """Begin to be patient."""
        self._last_progress = self.now.steady
        yield Report('watching the learner')

    def _follow(self, document: Document) -> Effects:
        if self.done or document['episode_id'] != self.episode_id:
            return
        self._last_progress = self.now.steady
        try:
            self._watch(document['turn'], tuple(documents.record_of(record) for record in document['queries']))
        except (Exception, SystemExit) as error:
            # SystemExit is how rich ends a program whose output nobody reads any more.
            self.failure = error
            raise
        self.done = document['done']
        yield from ()

    def _examine(self, statuses: Sequence[Status]) -> Effects:
        """Take an error of a node of this graph for the end, and a warning when nothing has happened for long."""
        for status in statuses:
            ours = status.name.startswith(f'{self._namespace}/')
            stalled = self.now.steady - self._last_progress > self._patience
            failed = status.health is Health.ERROR
            if ours and (failed or (stalled and status.health is Health.WARNING)):
                self.failure = EpisodeError(f'{status.name}: {status.message}')
        yield from ()
