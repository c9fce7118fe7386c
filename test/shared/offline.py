"""Questions of an episode without ROS, turn by turn."""

from __future__ import annotations

from collections import deque
from typing import Any

from al_questioner.domain import random_stream
from al_questioner.messages.documents import record_members
from al_questioner.questioning import Episode
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task, turns


def offline_queries(
    strategy: str,
    budget: float,
    n_turns: int,
    *,
    task: str = 'prepare_lunch',
    seed: int = 4,
    teacher: dict[str, Any] | None = None,
    **settings: Any,
) -> list[dict[str, Any]]:
    """The queries of an episode as a learner's state has them, without the held-out images of `run_episode`."""
    loaded = load_task(task)
    episode = Episode(episode_settings(loaded, strategy, budget, n_turns, **settings), random_stream(seed, 'learner'))
    scripted = ScriptedTeacher(loaded.symbols, loaded.relevant_groups, seed, **teacher or {})
    deque(turns(episode, PerceivedWorld(WorldSpec(loaded, seed, seed).open()), scripted), maxlen=0)
    return [record_members(record) for record in episode.records]
