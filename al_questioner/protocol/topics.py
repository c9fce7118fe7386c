"""The topics between the nodes, what is said on each, and how it reaches those who come late."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from al_questioner.domain import Decision, Recognition, Scene


class Delivery(Enum):
    """Whom a message reaches.

    A latched one reaches late listeners too, and only the newest counts. Of events every one counts, for those who
    listen when it is said.
    """

    LATCHED = 'latched'
    EVENTS = 'events'


TOPICS = {
    'episode': Delivery.LATCHED,
    'turn': Delivery.LATCHED,
    'objects': Delivery.LATCHED,
    'scene_image': Delivery.LATCHED,
    'scene_markers': Delivery.LATCHED,
    'query': Delivery.LATCHED,
    'answer': Delivery.EVENTS,
    'answer_ack': Delivery.EVENTS,
    'decision': Delivery.EVENTS,
    'learner_state': Delivery.LATCHED,
    'concepts': Delivery.LATCHED,
    'recognised': Delivery.LATCHED,
    'recognised_markers': Delivery.LATCHED,
    'recognition': Delivery.LATCHED,
    'detections': Delivery.LATCHED,
    'want': Delivery.EVENTS,
    'target': Delivery.EVENTS,
    'target_info': Delivery.EVENTS,
    '/diagnostics': Delivery.EVENTS,
}
"""Delivery of each topic by its relative name; /diagnostics is that of all robots.

Those that no class below speaks of carry texts.
"""


@dataclass(frozen=True, eq=False)
class Look:
    """Scene that is heard on `objects`, and has yet to be read.

    Attributes:
        stamp: of the cloud, in nanoseconds.
        frame_id: of the cloud.
        read: reads the scene, given the names of the features that are known by now.
    """

    stamp: int
    frame_id: str
    read: Callable[[Sequence[str]], Scene]


@dataclass(frozen=True, eq=False)
class SceneShown:
    """Scene that is said on `objects`, under a stamp in nanoseconds."""

    scene: Scene
    stamp: int
    frame_id: str


@dataclass(frozen=True, eq=False)
class PictureShown:
    """An (h, w, 3) picture that is said or heard on `scene_image`, under a stamp in nanoseconds."""

    picture: NDArray[np.uint8]
    stamp: int
    frame_id: str = ''


@dataclass(frozen=True, eq=False)
class PictureToDraw:
    """Picture that is said on `scene_image` and takes a while to draw: the caller may draw it aside, or drop it.

    Attributes:
        draw: makes the (h, w, 3) picture.
        stamp: in nanoseconds.
    """

    draw: Callable[[], NDArray[np.uint8]]
    stamp: int
    frame_id: str

    def drawn(self) -> PictureShown:
        """Draw the picture."""
        return PictureShown(self.draw(), self.stamp, self.frame_id)


@dataclass(frozen=True, eq=False)
class DecisionMade:
    """Choice of a turn that is said on `decision`, with the scene that it is about."""

    decision: Decision
    symbols: tuple[str, ...]
    scene: Scene
    stamp: int
    frame_id: str


@dataclass(frozen=True, eq=False)
class BeliefsShown:
    """Scene and beliefs that are said on `scene_markers`.

    Attributes:
        beliefs: (n, |Y|) q_y(x) of the scene.
        asked: object id of the thing that the pending query is about, if it is about one.
        question: text of the pending query; empty if there is none.
    """

    scene: Scene
    beliefs: NDArray[np.float64]
    symbols: tuple[str, ...]
    asked: int | None
    question: str
    stamp: int
    frame_id: str


@dataclass(frozen=True, eq=False)
class RecognitionShown:
    """Recognition that is said on `recognised`, `recognised_markers` and `detections`."""

    recognition: Recognition
    stamp: int
    frame_id: str


@dataclass(frozen=True)
class Place:
    """Position in metres that is said on `target`, in a frame at a time in nanoseconds."""

    position: tuple[float, float, float]
    stamp: int
    frame_id: str


@dataclass(frozen=True, eq=False)
class Replayed:
    """Cloud that is said on `objects` as it was recorded, under another stamp in nanoseconds."""

    data: bytes
    stamp: int


class Health(Enum):
    """Health of a node."""

    OK = 'ok'
    WARNING = 'warning'
    ERROR = 'error'
    STALE = 'stale'


class Status(NamedTuple):
    """Status of a node, as it is heard on `/diagnostics`, several in one message.

    Attributes:
        name: full name of the node, without the first slash.
        message: what it does, or what is wrong.
    """

    name: str
    health: Health
    message: str


@dataclass(frozen=True)
class Recorded:
    """Message as a recorder hears it, on any topic.

    Attributes:
        data: the message as it came.
        stamp: when it came, in nanoseconds since the epoch.
        read: reads the text of a message that holds one; an InputError says that it holds none.
    """

    data: bytes
    stamp: int
    read: Callable[[], str]
