"""Plan of an experiment: its episodes, and the settings that they share."""

from __future__ import annotations

import dataclasses
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

from al_questioner.concepts import Selector, rank_p_values, select_features
from al_questioner.domain import CARRY_LABELS, DEFAULT_CLASSIFIERS, Classifiers, SettingsError, price_of
from al_questioner.experiments.ceilings import CEILINGS
from al_questioner.questioning import (
    STRATEGIES,
    Strategy,
    UncertaintySampling,
    Weights,
    make_strategy,
    read_weights,
    shipped_file,
)
from al_questioner.simulation import Interval, Task, load_task
from al_questioner.simulation.scripted_teacher import RELEVANCE_FALSE_ALARM, RELEVANCE_OMISSION


@dataclass(frozen=True)
class Condition:
    """Limits of an episode: query budget, and number of turns."""

    budget: float
    turns: int

    def __str__(self) -> str:
        return f'{self.budget:g}/{self.turns}'


PAPER_CONDITIONS = {
    'C1': Condition(25, 40),
    'C2': Condition(25, 150),
    'C3': Condition(500, 40),
    'C4': Condition(500, 150),
}
"""Conditions of section 4.3 of the paper, by name."""
PAPER_STRATEGIES = ('u_sampling', 'dt_iros', 'dt_task', 'dt_task_env')
PAPER_METHOD = 'dt_task_env'
PROPOSED = ('value_per_cost',)
"""Strategies that we propose, in addition to those of the paper."""
CONTROLS = ('u_sampling_fsq', 'random_fsq', 'farthest_fsq', 'rarest_demo', 'typiclust', 'probcover')
PAPER_TASKS = ('prepare_lunch', 'pack_lunchbox')

SELECTORS: Mapping[str, Selector | None] = {
    'anova': select_features,
    'anova at .001': partial(select_features, significance=0.001),
    'anova, at least 20': partial(select_features, least=20),
    'Kruskal-Wallis': partial(select_features, p_values=rank_p_values),
    'none': None,
}
"""Computational feature selectors of u_sampling, by name; the first is its default."""


@dataclass(frozen=True)
class Variation:
    """Changes that an experiment makes to its tasks and learners; the default changes nothing.

    Attributes:
        change_interval: turns between scene changes; None for the task's.
        synchrony: probability that an object follows the common clock of states, in [0, 1]; None for the task's.
        wrong_rate: share of the teacher's answers that are wrong.
        unknown_rate: share of the queries that the teacher has no answer to.
        weights: by strategy, weights of its features; other strategies have the shipped ones.
        selector: selector of u_sampling, a key of `SELECTORS`.
        repeats: whether u_sampling may ask about a view that has been labelled.
        classifiers: settings of the classifiers.
        repeat_shown: whether the teacher may show a known object when there are unknown ones of the symbol.
        cost_relevance: cost of a relevance query, or `NEVER`; None for the task's.
        relevance_omission: chance that the teacher leaves out a thing that matters.
        relevance_false_alarm: chance that the teacher names a thing of no symbol among those that matter.
        carry_labels: whether a label counts for all views of an object.
    """

    change_interval: int | None = None
    synchrony: float | None = None
    wrong_rate: float = 0.0
    weights: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    selector: str = 'anova'
    repeats: bool = True
    unknown_rate: float = 0.0
    classifiers: Classifiers = DEFAULT_CLASSIFIERS
    repeat_shown: bool = False
    cost_relevance: float | str | None = None
    relevance_omission: float = RELEVANCE_OMISSION.default
    relevance_false_alarm: float = RELEVANCE_FALSE_ALARM.default
    carry_labels: bool = CARRY_LABELS.default

    def strategy(self, name: str) -> Strategy | None:
        """Return the varied strategy of this name; None for one that follows its settings."""
        return UncertaintySampling(SELECTORS[self.selector], self.repeats) if name == 'u_sampling' else None

    def task(self, name: str) -> Task:
        """Return the varied task.

        Raises:
            InputError: no such task.
        """
        task = self._with_costs(load_task(name))
        wanted: dict[str, Any] = {'change_interval': self.change_interval, 'synchrony': self.synchrony}
        changes = {name: value for name, value in wanted.items() if value is not None}
        if not changes:
            return task
        variety = task.variety
        if variety is not None and self.change_interval is not None:
            variety = dataclasses.replace(variety, change_interval=Interval(self.change_interval, self.change_interval))
        return dataclasses.replace(task, scenes=dataclasses.replace(task.scenes, **changes), variety=variety)

    def _with_costs(self, task: Task) -> Task:
        if self.cost_relevance is None:
            return task
        costs = dataclasses.replace(task.episode.costs, relevance=price_of(self.cost_relevance))
        return dataclasses.replace(task, episode=dataclasses.replace(task.episode, costs=costs))


def shipped_weights() -> Mapping[str, Weights]:
    """Return the weights in `config/weights` of the strategies that have some."""
    paths = {name: shipped_file(name) for name in (*PAPER_STRATEGIES, *PROPOSED)}
    return {name: read_weights(path) for name, path in paths.items() if path is not None}


def strategy_to_compare(strategies: Sequence[str], wanted: str | None = None) -> str | None:
    """Return which strategy is tested against the others.

    If none is wanted, it is the method of the paper, or, where that is not played, the first one that is named. None
    where only ceilings are played: what knows the truth is not tested.

    Raises:
        InputError: the wanted one is not played, or is a ceiling.
    """
    played = [name for name in strategies if name not in CEILINGS]
    if wanted is None:
        return PAPER_METHOD if PAPER_METHOD in played else next(iter(played), None)
    if wanted in CEILINGS:
        raise SettingsError(f'--compare {wanted}: it knows the truth, and is not tested against strategies')
    if wanted not in played:
        raise SettingsError(f'--compare {wanted}: not among the strategies that are played: {", ".join(strategies)}')
    return wanted


def task_label(name: str) -> str:
    """Return the name of a task in tables' headings and files' names: for a path, the name of the file."""
    return Path(name).stem if name.endswith('.yaml') else name


@dataclass(frozen=True, order=True)
class Cell:
    """One episode of an experiment. Sample, scenes and seed are the same for all strategies: the design is paired."""

    task: str
    budget: float
    turns: int
    strategy: str
    sample: int

    def __str__(self) -> str:
        return f'{self.task}, {self.condition}, {self.strategy}, sample {self.sample}'

    @property
    def condition(self) -> Condition:
        """Limits of the episode."""
        return Condition(self.budget, self.turns)

    @property
    def seed(self) -> int:
        """Seed of scenes, learner and teacher."""
        return self.sample


@dataclass(frozen=True)
class Plan:
    """All episodes of an experiment: every combination, but the ceilings perhaps on the first samples only.

    Attributes:
        tasks: names in `config/tasks`.
        conditions: limits.
        strategies: names.
        samples: numbers of samples of observations.
        variation: changes in all of them.
        ceiling_samples: number of samples, the first ones, that the ceilings are played on; None for all.

    Raises:
        InputError: an unknown task or strategy, one that cannot be imported, or nothing to play.
    """

    tasks: tuple[str, ...]
    conditions: tuple[Condition, ...]
    strategies: tuple[str, ...]
    samples: tuple[int, ...]
    variation: Variation = Variation()
    ceiling_samples: int | None = None

    def __post_init__(self) -> None:
        for name, values in (
            ('task', self.tasks),
            ('condition', self.conditions),
            ('strategy', self.strategies),
            ('sample', self.samples),
        ):
            if not values:
                raise SettingsError(f'the experiment has no {name}')
            if len(set(values)) < len(values):
                raise SettingsError(f'the experiment names a {name} twice')
        for strategy in self.strategies:
            if strategy == 'human':
                raise SettingsError('nobody can play an experiment by hand: strategy human is for demo and learner')
            if strategy not in CEILINGS and strategy not in STRATEGIES:
                make_strategy(strategy, {})
        self._check_tasks()

    def _check_tasks(self) -> None:
        """Find the task of each name.

        Raises:
            InputError: there is none, or two have the same name.
        """
        if len({task_label(name) for name in self.tasks}) < len(self.tasks):
            raise SettingsError('two tasks of the experiment have the same name')
        for name in self.tasks:
            self.variation.task(name)

    def groups(self) -> Iterator[tuple[Cell, ...]]:
        """Yield the cells in groups that share a world.

        They come sample by sample, so that the duration of the first ones predicts that of the others.
        """
        with_ceilings = self.samples[: self.ceiling_samples]
        for sample, task in itertools.product(self.samples, self.tasks):
            yield tuple(
                Cell(task, condition.budget, condition.turns, strategy, sample)
                for condition, strategy in itertools.product(self.conditions, self.strategies)
                if strategy not in CEILINGS or sample in with_ceilings
            )

    def cells(self) -> Sequence[Cell]:
        """Return all cells."""
        return [cell for group in self.groups() for cell in group]

    def task_document(self, name: str) -> dict[str, Any]:
        """Return all that determines the world of a task, for the manifest, as numbers and names."""

        def members(value: Any) -> Any:
            if dataclasses.is_dataclass(value):
                return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
            return dict(value) if isinstance(value, Mapping) else str(value)

        document: dict[str, Any] = json.loads(json.dumps(self.variation.task(name), default=members))
        return document

    def document(self) -> dict[str, Any]:
        """Return all that determines the results, for the manifest."""
        return dataclasses.asdict(self)
