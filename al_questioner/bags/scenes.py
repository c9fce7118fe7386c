"""Scenes of a recorded learner, turn by turn."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from al_questioner.bags.reading import Bag, BagError, BagMessage, deserialize
from al_questioner.bags.runs import Recorded, Run, recorded_in
from al_questioner.domain import SceneError
from al_questioner.messages.clouds import scene_of_cloud
from al_questioner.messages.documents import Document


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
    """Return the scenes of the episode in a bag, for which its topics `turn` and `objects` are enough.

    A turn whose scene was not recorded is left out.

    Raises:
        BagError: no scene, several episodes, or messages that are not those of an episode; the text names the bag.
    """
    spaces = recorded_in(bag, ('turn',))
    runs = [(recorded, run) for recorded in spaces for run in recorded.runs if run.begins]
    episodes = sorted({run.episode_id for _, run in runs})
    if len(episodes) > 1:
        raise BagError(f'{bag.path}: holds the scenes of several episodes: {", ".join(episodes)}')
    if len(runs) > len({recorded.namespace for recorded, _ in runs}):
        raise BagError(f'{bag.path}: episode {episodes[0]} begins several times in it')
    found = {turn: cloud for recorded, run in runs[:1] for turn, cloud in _clouds_taken(recorded, run)}
    if not found:
        hint = spaces[0].hint() if spaces else ''
        raise BagError(f'{bag.path}: no turn with its objects was recorded in it{hint}')
    return RecordedScenes(MappingProxyType(found), runs[0][1].world)


def _clouds_taken(recorded: Recorded, run: Run) -> Iterator[tuple[int, BagMessage]]:
    """Return, by turn, the first cloud that a learner can take: other nodes may publish on the same topic."""
    names: tuple[str, ...] = ()
    for turn in sorted(run.begins):
        for cloud in recorded.clouds(run, turn):
            with contextlib.suppress(BagError, SceneError):
                scene = scene_of_cloud(deserialize(cloud.message), names)
                names = names or scene.feature_names
                yield turn, cloud.message
                break
