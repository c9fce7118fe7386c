"""A session as a bag: what a recorder beside the learner would have written, each message once."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np

from al_questioner.bags.reading import BagError, Topic, typestore
from al_questioner.bags.topics import CLOUD, STRING, TYPES
from al_questioner.bags.writing import BagWriter
from al_questioner.event_log.events import ActionChosen, AnswerAccepted, EpisodeEvent, LateAnswerKept, SceneObserved
from al_questioner.event_log.replay import replay_of
from al_questioner.event_log.state_documents import episode_members, state_members
from al_questioner.event_log.summary import SessionSummary
from al_questioner.messages import documents
from al_questioner.messages.clouds import CloudTypes, cloud_of_decision, cloud_of_scene
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import SECOND, stamp_members
from al_questioner.questioning import Receipt
from al_questioner.questioning.answer_acknowledgement import acknowledgement

_VOLATILE = ('answer', 'answer_ack', 'decision')


def write_bag(summary: SessionSummary, path: Path) -> None:
    """Write the session into a new bag, its topics without a namespace, each message at the time of its event.

    Nothing is left of a bag that could not be written as a whole.

    Raises:
        BagError: something is at the path already, or it cannot be written to.
    """
    topics = [Topic(f'/{name}', type_, name not in _VOLATILE) for name, type_ in TYPES.items()]
    is_new = not path.exists()
    try:
        with BagWriter(path, topics) as bag:
            writing = _Writing(summary, bag)
            for stamp, event in summary.events[1:]:
                writing.write(stamp, event)
            writing.end_turn()
    except BaseException as error:
        if is_new:
            shutil.rmtree(path, ignore_errors=True)
        if isinstance(error, OSError):
            raise BagError(f'{path}: cannot be written ({error.strerror})') from error
        raise


class _Writing:
    """Turns events into messages, with a replay beside them that knows what was weighed and believed."""

    def __init__(self, summary: SessionSummary, bag: BagWriter) -> None:
        self._started = summary.started
        self._tuned_turns = summary.episode.tuned_turns
        self._replay = replay_of(summary.started)
        self._bag = bag
        self._stamp = 0
        self._types = typestore().types
        self._cloud_types = CloudTypes(
            self._types[CLOUD],
            self._types['sensor_msgs/msg/PointField'],
            lambda content: np.frombuffer(content, dtype=np.uint8),
        )

    def write(self, stamp: int, event: EpisodeEvent) -> None:
        """Write what was published because of an event."""
        if isinstance(event, SceneObserved):
            self.end_turn()
        self._replay.play(event)
        self._stamp = stamp
        if isinstance(event, SceneObserved):
            self._say('turn', {'turn': event.turn, 'stamp': stamp_members(event.stamp), 'world': self._started.world})
            self._send('objects', cloud_of_scene(event.scene, self._header(event), self._cloud_types))
        elif isinstance(event, ActionChosen):
            self._decided(event)
        elif isinstance(event, (AnswerAccepted, LateAnswerKept)):
            receipt, reason = Receipt.ACCEPTED, ''
            if isinstance(event, LateAnswerKept):
                receipt, reason = Receipt.LATE, event.reason
            self._say('answer', documents.answer_members(event.answer))
            self._say('answer_ack', acknowledgement(event.answer, receipt, reason))

    def end_turn(self) -> None:
        """Write the state of the learner after a turn; none before the first, and none while it waits."""
        observed, episode = self._replay.observed, self._replay.episode
        if observed is not None and not episode.awaits_answer:
            beliefs = episode.concepts.predict_proba(episode.scene.features)
            self._say('learner_state', state_members(episode, beliefs))

    def _decided(self, event: ActionChosen) -> None:
        observed, decision = self._replay.observed, self._replay.decision
        if observed is None or decision is None:
            return
        if event.turn == 1:
            names = observed.scene.feature_names
            self._say('episode', episode_members(self._started, names, self._tuned_turns))
        symbols = self._started.settings.symbols
        cloud = cloud_of_decision(decision, symbols, self._header(observed), self._cloud_types, observed.scene)
        self._send('decision', cloud)
        if event.query is not None:
            self._say('query', {**documents.query_members(event.query), 'world': self._started.world})

    def _header(self, observed: SceneObserved) -> Any:
        time = self._types['builtin_interfaces/msg/Time'](observed.stamp // SECOND, observed.stamp % SECOND)
        return self._types['std_msgs/msg/Header'](time, observed.frame_id)

    def _say(self, name: str, members: Document) -> None:
        self._send(name, self._types[STRING](documents.write(name, self._started.episode_id, members)))

    def _send(self, name: str, message: Any) -> None:
        self._bag.write(f'/{name}', bytes(typestore().serialize_cdr(message, TYPES[name])), self._stamp)
