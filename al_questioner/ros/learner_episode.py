"""The episode that a learner's parameters ask for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from al_questioner import __version__
from al_questioner.domain import (
    COST_RELEVANCE,
    COSTS,
    NO_SYMBOL,
    Costs,
    EpisodeSettings,
    InputError,
    Knowledge,
    price_of,
)
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import SessionLog
from al_questioner.event_log.storage import StorageFactory
from al_questioner.messages.concepts_file import read_concepts
from al_questioner.questioning import Strategy
from al_questioner.ros.settings import CONCEPTS
from al_questioner.ros.worlds import new_episode_id, world_members
from al_questioner.simulation import Task, WorldSpec, episode_settings
from al_questioner.support.files import check_writable
from al_questioner.support.text import number_of

CONCEPTS_FILE = 'concepts.json'
"""Name of the concepts file in the folder of a log."""


def known_concepts(given: Mapping[str, Any]) -> Knowledge | None:
    """Return what the file that the parameters name tells; None if they name none.

    Raises:
        InputError: it cannot be used.
    """
    path = str(given[CONCEPTS.name])
    return read_concepts(Path(path).expanduser()) if path else None


def concepts_files(given: Mapping[str, Any]) -> list[Path]:
    """Return the files to which what is known is to be written.

    Raises:
        InputError: the one that the parameters name cannot be written.
    """
    own = Path(str(given['save_concepts'])).expanduser() if given['save_concepts'] else None
    if own is not None:
        check_writable(own)
    folder = session_folder(given)
    return [path for path in (own, None if folder is None else folder / CONCEPTS_FILE) if path is not None]


def notes_on_known(settings: EpisodeSettings) -> tuple[str, str]:
    """Return what people are told of the concepts that an episode begins with: what is known, and what is doubtful."""
    known = settings.concepts
    if known is None:
        return '', ''
    new, of_none = [symbol for symbol in settings.symbols if symbol not in known.symbols], known.counts[NO_SYMBOL]
    doubtful = (
        f'{", ".join(new)}: new, while {number_of(of_none, "thing")} of {NO_SYMBOL} {_verb(of_none)} known from before;'
        ' if one is of that symbol, have its example removed from the concepts file: `concepts FILE --examples` shows'
        ' them, `concepts FILE --remove VIEW --out FILE` removes one'
    )
    count = len(known.examples)
    return f'{number_of(count, "example")} {_verb(count)} known', doubtful if new and of_none else ''


def _verb(count: int) -> str:
    return 'is' if count == 1 else 'are'


def session_folder(given: Mapping[str, Any]) -> Path | None:
    """Return the folder of the log; None for none."""
    return Path(str(given['session'])).expanduser() if given['session'] else None


def settings_of(task: Task, given: Mapping[str, Any], known: Knowledge | None = None) -> EpisodeSettings:
    """Return the settings that the parameters state, with what is known already.

    Raises:
        InputError: they cannot be used.
    """
    return episode_settings(
        task,
        strategy=given['strategy'],
        budget=given['budget'],
        turns=given['turns'],
        change_interval=given['change_interval'],
        weights_file=given['weights_file'] or None,
        costs=Costs(
            **{name: given[price.name] for name, price in COSTS.items()},
            relevance=price_of(given[COST_RELEVANCE.name]),
        ),
        amplitude=given['amplitude'],
        kernel_shape=given['kernel_shape'],
        class_balance=given['class_balance'],
        length_scale=given['length_scale'] or None,
        concepts=known,
        carry_labels=bool(given['carry_labels']),
    )


def durable_episode_of(
    settings: EpisodeSettings, strategy: Strategy, world: WorldSpec, given: Mapping[str, Any], storage: StorageFactory
) -> DurableEpisode:
    """Return the episode of these parameters, new or as far as its log goes, not yet started.

    Raises:
        InputError: the log cannot be used, or is that of an episode with other settings; or the file to which what is
            known is to be written holds examples that this episode does not begin with.
    """
    folder = session_folder(given)
    log = None if folder is None else SessionLog(folder, storage)
    is_new = log is None or not log.events
    wanted = EpisodeStarted(
        episode_id=str(given['episode_id']) or (new_episode_id(world) if is_new else ''),
        settings=settings,
        seed=world.seed,
        view_tolerance=given['view_tolerance'],
        world=world_members(world),
        version=__version__,
    )
    try:
        durable = DurableEpisode(wanted, strategy, log)
        _check_nothing_is_lost(given, durable.started)
        return durable
    except InputError:
        if log is not None:
            log.close()
        raise


def _check_nothing_is_lost(given: Mapping[str, Any], started: EpisodeStarted) -> None:
    """Make sure that what is in the file to be written is known to the learner that writes it.

    Raises:
        InputError: it is not; or the file is no concepts file.
    """
    path = Path(str(given['save_concepts'])).expanduser()
    if not given['save_concepts'] or not path.exists():
        return
    kept, known = read_concepts(path), started.settings.concepts
    is_resumed = started.episode_id in {origin.episode for origin in kept.origins}
    is_known = known is not None and known.lessons[: len(kept.lessons)] == kept.lessons
    if kept.examples and not (is_resumed or is_known):
        count = number_of(len(kept.examples), 'example')
        raise InputError(
            f'{path} holds {count} that this learner does not begin with and would replace: add concepts:={path} to go'
            ' on with them, or save to another file'
        )
