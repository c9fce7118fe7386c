"""What a recorded learner saw in each turn, as it was recorded."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from al_questioner.domain import InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import nanoseconds, stamp_of
from al_questioner.recording.bags import Bag, BagError, BagMessage, deserialize
from al_questioner.recording.session import TYPES, taken_cloud


@dataclass(frozen=True)
class RecordedScenes:
    """The scenes of one recorded episode.

    Attributes:
        clouds: by turn, the message on `objects` that the learner took.
        world: the simulated world that the learner spoke of; None if it was another one.
    """

    clouds: Mapping[int, BagMessage]
    world: Document | None


def scenes_of(bag: Bag) -> RecordedScenes:
    """The scenes of the episode in a bag, for which its topics `turn` and `objects` are enough.

    A turn whose scene was not recorded is left out.

    Raises:
        BagError: no scene, several episodes, or messages that are not those of an episode; the text names the bag.
    """
    try:
        turns = [documents.read('turn', deserialize(message).data) for message in _on(bag, 'turn')]
        clouds = [(nanoseconds(deserialize(message).header.stamp), message) for message in _on(bag, 'objects')]
    except BagError:
        raise
    except InputError as error:
        raise BagError(f'{bag.path}: {error}') from error
    episodes = sorted({document['episode_id'] for document in turns})
    if len(episodes) > 1:
        raise BagError(f'{bag.path}: holds the scenes of several episodes: {", ".join(episodes)}')
    # A turn may have been asked for several times, in the same words.
    turns = sorted({document['turn']: document for document in turns}.values(), key=lambda document: document['turn'])
    begins = [stamp_of(document['stamp']) for document in turns]
    found = {}
    for document, begin, end in zip(turns, begins, [*begins[1:], math.inf], strict=False):
        taken = taken_cloud(clouds, begin, end)
        if taken is not None:
            found[int(document['turn'])] = taken
    if not found:
        raise BagError(f'{bag.path}: no turn with its objects was recorded in it')
    return RecordedScenes(MappingProxyType(found), turns[0]['world'])


def _on(bag: Bag, name: str) -> list[BagMessage]:
    found = [message for message in bag.messages if message.topic.rsplit('/', 1)[-1] == name]
    for message in found:
        if message.type != TYPES[name]:
            raise BagError(f'{bag.path}: topic {message.topic} holds {message.type}, expected {TYPES[name]}')
    return found
