"""Machine of the recorder: has every message recorded as it came, and notices holes and the end of an episode."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path

from al_questioner.domain import EpisodeError, InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.effects import CloseBag, Effects, Level, Record, Report, Say, SetTimer, SyncBag
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import Recorded

SYNC_PERIOD = 0.5
"""Seconds from one time at which all is brought to the disk to the next: what a crash can cost."""
DRAIN = 1.0
"""Seconds after the end of an episode in which messages are still taken."""
SYNC, DRAINED = 'sync', 'drained'
"""Timers: when all is brought to the disk, and when no more messages are awaited."""


class RecorderMachine(Machine):
    """Records every message of its topics as it came, and brings it to the disk twice a second.

    Args:
        path: of the bag, which is begun already.
        names: name in the bag of each topic that it records, by its relative name.
        until_done: whether it is to end by itself once the episode is over.
        failure_of: makes the failure of an error of the disk; an EpisodeError if some of the bag can be repaired.

    Attributes:
        path: of the bag.
        until_done: as it was given.
        done: whether the episode is over, and all is written.
        failure: what has made the recording impossible.
    """

    def __init__(
        self,
        path: Path,
        names: Mapping[str, str],
        until_done: bool,
        failure_of: Callable[[OSError], EpisodeError | InputError],
    ) -> None:
        super().__init__()
        self.path = path
        self.until_done = until_done
        self.done = False
        self.failure: EpisodeError | InputError | None = None
        self._failure_of = failure_of
        self._names = names
        self._written = Counter[str](dict.fromkeys(names, 0))
        self._last_turns: dict[str, int] = {}
        self._missed = 0
        self._seen_alive: set[str] = set()
        self._is_ending = False
        for topic in names:
            self.on(topic, partial(self._record, topic))
        self.on_timer(SYNC, self._sync_again)
        self.on_timer(DRAINED, self._end)

    @property
    def written(self) -> int:
        """Number of messages in the bag."""
        return self._written.total()

    def counts(self) -> Mapping[str, int]:
        """Return the number of messages written, by topic, and of turns that were not heard."""
        written = {f'written of {name}': self._written[topic] for topic, name in self._names.items()}
        return {**written, 'turns missed': self._missed}

    def start(self) -> Effects:
        """Say where the recording goes."""
        yield Report(f'recording to {self.path}')
        yield Say(f'recording to {self.path}')
        yield SetTimer(SYNC, SYNC_PERIOD)

    def finish(self) -> Effects:
        """Finish the bag. It is the last that is asked of the machine.

        Raises:
            EpisodeError: the recording has failed, and can be repaired.
        """
        try:
            yield CloseBag()
        except OSError as error:
            self._fail(error)

    def _record(self, topic: str, message: Recorded) -> Effects:
        if self.failure is not None:
            return
        try:
            yield Record(topic, message.data, message.stamp)
        except OSError as error:
            self._fail(error)
            return
        self._written[topic] += 1
        if topic in ('turn', 'learner_state'):
            yield from self._look_into(topic, documents.read(topic, message.read()))

    def _look_into(self, kind: str, document: Document) -> Effects:
        """Say if a turn of an episode was missed; notice its end."""
        episode_id = document['episode_id']
        if kind == 'turn':
            turn, before = document['turn'], self._last_turns.get(episode_id, 0)
            if episode_id not in self._last_turns:
                yield Say(f'recording episode {episode_id} from turn {turn} on')
            if turn > before + 1:
                self._missed += turn - before - 1
                yield Say(
                    f'turns {before + 1} to {turn - 1} of episode {episode_id} were missed:'
                    ' the recording cannot be used as a demonstration',
                    Level.WARNING,
                )
            self._last_turns[episode_id] = max(turn, before)
        if document.get('turn') == 1 or not document.get('done', True):
            self._seen_alive.add(episode_id)
        # The latched state of a learner that was done before the recording began is no end of it.
        is_end = kind == 'learner_state' and document['done'] and episode_id in self._seen_alive
        if is_end and self.until_done and not self._is_ending:
            # Once: a state that is repeated must not put the end off.
            self._is_ending = True
            yield SetTimer(DRAINED, DRAIN)

    def _end(self) -> Effects:
        yield from self._sync()
        self.done = True

    def _sync_again(self) -> Effects:
        yield SetTimer(SYNC, SYNC_PERIOD)
        yield from self._sync()

    def _sync(self) -> Effects:
        if self.failure is not None:
            return
        try:
            yield SyncBag()
        except OSError as error:
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        """End the recording.

        Raises:
            EpisodeError: what is on the disk stays as it is, and can be repaired.
        """
        self.failure = self._failure_of(error)
        if isinstance(self.failure, EpisodeError):
            raise self.failure from error
