"""The episodes that a bag holds, and what of it cannot be used."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from al_questioner.bags.events import decode_run
from al_questioner.bags.reading import BagError, read_bag
from al_questioner.bags.recorded_episode import RecordedEpisode
from al_questioner.bags.runs import Recorded, recorded_in
from al_questioner.domain import InputError


class LeftOut(NamedTuple):
    """Something of a bag that cannot be used.

    Attributes:
        what: id of the episode, or the namespace if that is not known.
        reason: which turns, if not all, and why.
    """

    what: str
    reason: str


def read_episodes(path: Path, left_out: list[LeftOut] | None = None) -> list[RecordedEpisode]:
    """Return all episodes of a bag in the order in which they began; what other nodes say on such topics is left out.

    An episode that was over before the recording began is none of the bag's: only latched topics tell of it. A list
    `left_out` takes what cannot be used beside what can; if it is not given, all must be.

    Raises:
        BagError: not a bag, a broken one, or one without an episode that can be used; the text names the bag.
    """
    whole = recorded_in(read_bag(path), ('episode', 'turn'))
    found = [each for recorded in whole for each in _episodes(path, recorded)]
    episodes = [each for each in found if isinstance(each, RecordedEpisode)]
    missing = [each for each in found if isinstance(each, LeftOut)]
    if missing and (left_out is None or not episodes):
        raise BagError(f'{path}: {missing[0].reason}')
    if not episodes:
        raise BagError(f'{path}: no episode was recorded in it (no message on a topic named episode)')
    if left_out is not None:
        left_out += missing
    return episodes


def _episodes(path: Path, recorded: Recorded) -> Iterator[RecordedEpisode | LeftOut]:
    """Yield the episodes of a namespace, and what of them cannot be used."""
    is_one_whole = any(run.document is not None and 1 in run.begins for run in recorded.runs)
    for run in recorded.runs:
        decided = [turn for turn, begin in sorted(run.begins.items()) if recorded.decision(begin) is not None]
        if run.document is None:
            if decided:
                topic = f'{recorded.namespace}/episode'
                yield LeftOut(run.episode_id, f'no episode was recorded for its turns ({topic}){recorded.hint()}')
            continue
        if is_one_whole and not decided and 1 not in run.begins:
            # Latched topics tell a recorder of an episode that was over before it began.
            continue
        try:
            episode = decode_run(path, recorded, run, run.document)
        except InputError as error:
            yield LeftOut(run.episode_id, str(error))
            continue
        yield episode
        beyond = [turn for turn in decided if turn > episode.decisions]
        if beyond:
            turns = f'turn {beyond[0]}' if len(beyond) == 1 else f'turns {beyond[0]} to {beyond[-1]}'
            before = 'what was answered before was not recorded (no message on learner_state)'
            yield LeftOut(run.episode_id, f'{turns}: {before}{recorded.hint()}')
    if recorded.faults and not any(run.document is not None for run in recorded.runs):
        yield LeftOut(recorded.namespace or '/', recorded.faults[0])
