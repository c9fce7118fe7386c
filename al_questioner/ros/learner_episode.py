"""The episode that a learner's parameters ask for."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from al_questioner import __version__
from al_questioner.domain import COST_RELEVANCE, COSTS, Costs, EpisodeSettings, InputError, price_of
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.event_log.log import SessionLog
from al_questioner.event_log.storage import StorageFactory
from al_questioner.questioning import Strategy
from al_questioner.ros.worlds import new_episode_id, world_members
from al_questioner.simulation import Task, WorldSpec, episode_settings


def settings_of(task: Task, given: Mapping[str, Any]) -> EpisodeSettings:
    """Return the settings that the parameters state.

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
    )


def durable_episode_of(
    settings: EpisodeSettings, strategy: Strategy, world: WorldSpec, given: Mapping[str, Any], storage: StorageFactory
) -> DurableEpisode:
    """Return the episode of these parameters, new or as far as its log goes, not yet started.

    Raises:
        InputError: the log cannot be used, or is that of an episode with other settings.
    """
    folder = Path(str(given['session'])).expanduser() if given['session'] else None
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
        return DurableEpisode(wanted, strategy, log)
    except InputError:
        if log is not None:
            log.close()
        raise
