"""The events of an episode as lines of a session log."""

from __future__ import annotations

import base64
import json

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Action, Scene
from al_questioner.event_log.events import (
    ActionChosen,
    AnswerAccepted,
    EpisodeEvent,
    EpisodeStarted,
    InputRejected,
    KernelTuned,
    LateAnswerKept,
    SceneObserved,
    TurnTimedOut,
    kind_of,
)
from al_questioner.event_log.log import LogContents
from al_questioner.event_log.storage import Event
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.questioning.semantics import EARLIEST_SEMANTICS
from al_questioner.support.text import one_line

LONGEST_REFUSED = 1000
"""Characters of a refused text that are kept."""


class Encoder:
    """Writes events as lines of a log; a scene that is the last one again is written as a reference."""

    def __init__(self) -> None:
        self._last: SceneObserved | None = None

    def encode(self, event: EpisodeEvent) -> tuple[str, bytes]:
        """Return kind and content."""
        return kind_of(event), json.dumps(self._members(event), allow_nan=False, separators=(',', ':')).encode()

    def _members(self, event: EpisodeEvent) -> Document:
        if isinstance(event, EpisodeStarted):
            return event.members()
        if isinstance(event, SceneObserved):
            last, self._last = self._last, event
            scene = None if last is not None and last.scene.equals(event.scene) else _scene_members(event.scene)
            return {'turn': event.turn, 'stamp': event.stamp, 'frame_id': event.frame_id, 'scene': scene}
        if isinstance(event, ActionChosen):
            query = None if event.query is None else documents.query_members(event.query)
            return {'turn': event.turn, 'action': documents.members_of(event.action), 'query': query}
        if isinstance(event, AnswerAccepted):
            return documents.answer_members(event.answer)
        if isinstance(event, LateAnswerKept):
            return {**documents.answer_members(event.answer), 'reason': event.reason}
        if isinstance(event, InputRejected):
            counted = {} if event.count == 1 else {'count': event.count}
            return {'text': event.text[:LONGEST_REFUSED], 'reason': event.reason, **counted}
        return dict(vars(event))

    def follow(self, event: EpisodeEvent) -> None:
        """Take note of an event that is in the log already."""
        if isinstance(event, SceneObserved):
            self._last = event


def decoded(contents: LogContents) -> tuple[list[EpisodeEvent], str | None]:
    """Return the events of a log up to the first that cannot be understood, and what is wrong with it, if anything."""
    found: list[EpisodeEvent] = []
    last: Scene | None = None
    for event in contents.events:
        try:
            understood = _decode(event, json.loads(event.content), last)
        except (KeyError, TypeError, ValueError) as error:
            return found, f'event {event.number} ({event.kind}) cannot be understood ({one_line(error)})'
        if isinstance(understood, SceneObserved):
            last = understood.scene
        found.append(understood)
    return found, contents.damage


def _decode(event: Event, members: Document, last: Scene | None) -> EpisodeEvent:
    if event.kind == 'episode':
        return EpisodeStarted(
            settings=documents.settings_of(members),
            **{name: members[name] for name in ('episode_id', 'seed', 'view_tolerance', 'world', 'version')},
            semantics=members.get('semantics', EARLIEST_SEMANTICS),
        )
    if event.kind == 'scene':
        scene = last if members['scene'] is None else _scene_of(members['scene'])
        if scene is None:
            raise ValueError('it refers to a scene before, and there is none')
        return SceneObserved(members['turn'], members['stamp'], members['frame_id'], scene)
    if event.kind == 'decision':
        query = None if members['query'] is None else documents.query_of(members['query'])
        return ActionChosen(members['turn'], documents.read_as(Action, members['action']), query)
    if event.kind in ('answer', 'correction'):
        return AnswerAccepted(documents.answer_of(members))
    if event.kind == 'late':
        return LateAnswerKept(documents.answer_of(members), members['reason'])
    if event.kind == 'refused':
        return InputRejected(members['text'], members['reason'], members.get('count', 1))
    if event.kind == 'passed':
        return TurnTimedOut(members['turn'], members['query_id'])
    if event.kind == 'tune':
        return KernelTuned(members['turn'], members['model_version'])
    raise ValueError(f'unknown kind {event.kind!r}')


def _scene_members(scene: Scene) -> Document:
    return {
        'object_ids': list(scene.object_ids),
        'feature_names': list(scene.feature_names),
        'positions': _text_of(scene.positions),
        'features': _text_of(scene.features),
    }


def _scene_of(members: Document) -> Scene:
    ids, names = tuple(members['object_ids']), tuple(members['feature_names'])
    return Scene(
        object_ids=ids,
        positions=_numbers_of(members['positions'], len(ids), 3),
        features=_numbers_of(members['features'], len(ids), len(names)),
        feature_names=names,
    )


def _text_of(numbers: NDArray[np.float32]) -> str:
    """Their bits, as little-endian float32 in base64."""
    return base64.b64encode(np.asarray(numbers, dtype='<f4').tobytes()).decode()


def _numbers_of(text: str, rows: int, columns: int) -> NDArray[np.float32]:
    return np.frombuffer(base64.b64decode(text, validate=True), '<f4').astype(np.float32).reshape(rows, columns)
