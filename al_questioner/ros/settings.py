"""The parameters of every node; those that other parts share are declared where their values are used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeAlias

from al_questioner.bags.settings import STORAGE
from al_questioner.domain import (
    AMPLITUDE,
    BUDGET,
    CARRY_LABELS,
    CHANGE_INTERVAL,
    CLASS_BALANCE,
    COST_RELEVANCE,
    COSTS,
    KERNEL_SHAPE,
    LENGTH_SCALE,
    NEVER,
    SAME_VIEW,
    THRESHOLD,
    TURNS,
    Knowledge,
    Setting,
)
from al_questioner.questioning.strategies.names import STRATEGY
from al_questioner.questioning.strategies.weights import WEIGHTS_FILE
from al_questioner.simulation import Task
from al_questioner.simulation.scripted_teacher import (
    RELEVANCE_FALSE_ALARM,
    RELEVANCE_OMISSION,
    REPEAT_SHOWN,
    UNKNOWN_RATE,
    WRONG_RATE,
)
from al_questioner.simulation.world_spec import DATASET, SAMPLE, SEED, TASK

Settings: TypeAlias = Sequence[Setting[Any]]

WORLD_SETTINGS: Settings = (TASK, DATASET, SEED, SAMPLE)
"""Settings of the simulated world, on which perception, learner and teacher must agree."""

WAIT_FOR_RECORDER = Setting('wait_for_recorder', False, 'do nothing before a node named recorder listens')

PERCEPTION_SETTINGS: Settings = (
    Setting('frame_id', 'table', 'frame of the objects and of the picture'),
    WAIT_FOR_RECORDER,
)

_OF_MODE = "who answers: scripted, or terminal: a person at this process's terminal"
TEACHER_SETTINGS: Settings = (
    Setting('mode', 'scripted', _OF_MODE, choices=('scripted', 'terminal')),
    Setting('teacher_id', '', "name under which the answers are given; empty: scripted, or the person's login name"),
    WRONG_RATE,
    UNKNOWN_RATE,
    RELEVANCE_OMISSION,
    RELEVANCE_FALSE_ALARM,
    REPEAT_SHOWN,
    Setting('delay', 0.0, 'time the teacher takes to answer', 's', 0, 3600),
    WAIT_FOR_RECORDER,
)

TURN_PERIOD = Setting('turn_period', 0.0, 'least time from turn to turn; 0: as fast as they can go', 's', 0, 3600)
_ABOUT_TIMEOUT = 'time after which a turn goes on without its answer, doubled each time up to eightfold; 0: never'
CONCEPTS = Setting('concepts', '', 'concepts file of what is known before the first turn; empty: nothing is')
LEARNER_SETTINGS: Settings = (
    STRATEGY,
    WEIGHTS_FILE,
    BUDGET,
    TURNS,
    CHANGE_INTERVAL,
    *COSTS.values(),
    COST_RELEVANCE,
    Setting('answer_timeout', 120.0, _ABOUT_TIMEOUT, 's', 0, 86400),
    AMPLITUDE,
    KERNEL_SHAPE,
    CLASS_BALANCE,
    # No parameter can be None.
    replace(LENGTH_SCALE, default=0.0, lower=0.0),
    SAME_VIEW,
    CARRY_LABELS,
    TURN_PERIOD,
    Setting('episode_id', '', 'of the episode in all documents; empty: one that is not used again'),
    Setting('session', '', 'folder of the log that the episode is written to and goes on from; empty: none'),
    CONCEPTS,
    Setting('save_concepts', '', "file for what is known, written after each answer; empty: none but the session's"),
    WAIT_FOR_RECORDER,
)

_OF_FILE = "concepts file of what is known; empty: what the session's log holds, or what a learner tells"
_OF_LOG = 'folder of the log of a session, up to now; empty: none'
RECOGNISER_SETTINGS: Settings = (
    replace(CONCEPTS, description=_OF_FILE),
    Setting('session', '', _OF_LOG),
    THRESHOLD,
)

RECORDER_SETTINGS: Settings = (
    Setting('bag', '', 'directory of the new bag; empty: al_questioner_ and the date and time'),
    STORAGE,
    Setting('namespace_in_bag', '', 'under which the bag names the topics of this namespace; empty: their own'),
    Setting('until_done', False, 'end by itself when the learner says that its episode is over'),
)

ALL_NAMES = frozenset(
    setting.name
    for settings in (
        WORLD_SETTINGS,
        PERCEPTION_SETTINGS,
        TEACHER_SETTINGS,
        LEARNER_SETTINGS,
        RECOGNISER_SETTINGS,
        RECORDER_SETTINGS,
    )
    for setting in settings
)
"""Every parameter of every node: a file for all nodes sets parameters that a single one does not have."""


def learner_settings(task: Task, known: Knowledge | None = None) -> Settings:
    """Return the learner's parameters, with the values of the task, and of what is known already, as defaults."""
    relevance = task.episode.costs.relevance
    defaults: dict[str, Any] = {
        STRATEGY.name: task.episode.strategy,
        BUDGET.name: task.episode.budget,
        TURNS.name: task.episode.turns,
        CHANGE_INTERVAL.name: task.scenes.change_interval,
        **{price.name: getattr(task.episode.costs, name) for name, price in COSTS.items()},
        COST_RELEVANCE.name: NEVER if relevance is None else relevance,
    }
    if known is not None:
        defaults |= {**known.classifiers._asdict(), LENGTH_SCALE.name: known.length_scale or 0.0}
    return [replace(each, default=defaults.get(each.name, each.default)) for each in LEARNER_SETTINGS]
