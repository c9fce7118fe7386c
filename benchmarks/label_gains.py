"""Worth of one more label, and the detection of things of a symbol among clutter: measured, not estimated.

    python benchmarks/label_gains.py [--task TASK ...] [--strategy STRATEGY ...] [--budget B] [--turns T]
                                     [--first SEED] [--samples N] [--every K] [--jobs N]

Every K turns of an episode each view in sight that has not been labelled is labelled, by itself, with what it is, and
the change of accuracy on held-out views noted. The first table holds the mean change, in thousandths, its standard
error, and how many there were: of things that the classifiers call something else, of those that they call right (in a
tie: neither), by how many examples of their symbol there were; and of things of no symbol. The second holds the area
under the ROC curve, 0.5 for guessing, of two scores that a thing is of some symbol: the classifiers' odds, and the
beliefs of value_per_cost.
"""

from __future__ import annotations

import argparse
import itertools
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from typing import NamedTuple

import numpy as np
from measuring import print_table
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu

from al_questioner.concepts import Selector
from al_questioner.domain import NO_SYMBOL, InputError, random_stream
from al_questioner.questioning import STRATEGIES, Choice, Episode, Strategy, TurnContext, make_strategy
from al_questioner.questioning.beliefs import class_beliefs
from al_questioner.questioning.strategies.names import contributions
from al_questioner.questioning.strategies.value_per_cost import DEFAULTS, called_shares
from al_questioner.simulation import (
    PerceivedWorld,
    ScriptedTeacher,
    WorldSpec,
    accuracy,
    episode_settings,
    load_task,
    turns,
)
from al_questioner.support.arguments import NumberWithin

EXAMPLES = (range(1), range(1, 2), range(2, 4), range(4, 8), range(8, 1000))
"""Groups of numbers of examples."""


class Case(NamedTuple):
    """One episode, and how often to measure."""

    task: str
    strategy: str
    sample: int
    budget: float
    turns: int
    every: int


class Label(NamedTuple):
    """A label of a view, with what it would have changed.

    Attributes:
        symbol: what it is, or none.
        examples: of its symbol, before it.
        called: share of its symbol among those that the classifiers held for most probable.
        gain: of accuracy.
        odds: of its being of a symbol, by the classifiers.
        belief: that it is of a symbol, by value_per_cost.
    """

    symbol: str
    examples: int
    called: float
    gain: float
    odds: float
    belief: float


class Measuring:
    """A strategy that measures, before each choice that is due, what labels would be worth."""

    def __init__(self, strategy: Strategy, world: PerceivedWorld, every: int) -> None:
        self._strategy, self._world, self._every = strategy, world, every
        self.found: list[Label] = []

    @property
    def selector(self) -> Selector | None:
        """Selector of the strategy."""
        return self._strategy.selector

    def choose(self, context: TurnContext, rng: np.random.Generator) -> Choice:
        """The strategy's choice."""
        if context.turn % self._every == 0:
            self.found += measured(context, self._world.truth(context.turn), self._world.test_set)
        return self._strategy.choose(context, rng)


def measured(
    context: TurnContext, truth: Mapping[int, str], test_set: tuple[NDArray[np.float32], Sequence[str]]
) -> list[Label]:
    """The labels of all views in sight that have none."""
    concepts, scene, symbols = context.concepts, context.scene, context.symbols
    rows = np.flatnonzero(~context.labelled)
    if len(rows) == 0:
        return []
    names = [truth[scene.object_ids[row]] for row in rows]
    features, labels = test_set
    before = accuracy(concepts.predict_proba(features), labels, symbols)
    after = concepts.predict_after_each(scene.features[rows], names, features)
    q = context.probabilities[rows]
    called = called_shares(q)
    odds = (q / (1 - q)).sum(axis=1)
    beliefs = 1 - class_beliefs(context, DEFAULTS.reach, DEFAULTS.doubt)[rows, -1]
    found = []
    for i, name in enumerate(names):
        share = 0.0 if name == NO_SYMBOL else float(called[i, symbols.index(name)])
        gain = accuracy(after[i], labels, symbols) - before
        found.append(Label(name, concepts.positives.get(name, 0), share, gain, float(odds[i]), float(beliefs[i])))
    return found


def play(case: Case) -> list[Label]:
    """The labels that an episode measured."""
    world_spec = WorldSpec(load_task(case.task), case.sample, case.sample)
    settings = episode_settings(world_spec.task, case.strategy, case.budget, case.turns)
    world = PerceivedWorld(world_spec.open())
    strategy = Measuring(make_strategy(settings.strategy, settings.weights), world, case.every)
    teacher = ScriptedTeacher(world_spec.task.symbols, world_spec.task.relevant_groups, case.sample, repeat_shown=True)
    for _ in turns(Episode(settings, random_stream(case.sample, 'learner'), strategy=strategy), world, teacher):
        pass
    return strategy.found


def gain_rows(task: str, labels: Sequence[Label]) -> list[list[str]]:
    """A row for each way in which the classifiers call a view, a column for each number of examples."""
    named = [label for label in labels if label.symbol != NO_SYMBOL]
    groups = {
        'something else': [label for label in named if label.called == 0],
        'right': [label for label in named if label.called == 1],
    }
    rows = [
        [
            f'{task}, called {how}',
            *(mean_text([label.gain for label in group if label.examples in n]) for n in EXAMPLES),
        ]
        for how, group in groups.items()
    ]
    none = [label.gain for label in labels if label.symbol == NO_SYMBOL]
    return [*rows, [f'{task}, of no symbol', mean_text(none), *[''] * (len(EXAMPLES) - 1)]] if none else rows


def mean_text(gains: Sequence[float]) -> str:
    """Mean in thousandths with its standard error, and number."""
    if len(gains) < 2:
        return ''
    return f'{1000 * np.mean(gains):+.1f} ± {1000 * np.std(gains, ddof=1) / len(gains) ** 0.5:.1f} ({len(gains)})'


def area_under_curve(scores: Sequence[float], positive: Sequence[bool]) -> float:
    """Chance that a positive has a larger score than a negative, ties counting half; NaN without any of either."""
    scores_of = [
        [score for score, is_positive in zip(scores, positive, strict=True) if is_positive is which]
        for which in (True, False)
    ]
    if not all(scores_of):
        return float('nan')
    ours, others = scores_of
    return float(mannwhitneyu(ours, others).statistic / (len(ours) * len(others)))


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--task', nargs='+', default=['prepare_lunch', 'pack_lunchbox', 'kitchen_table'])
    strategies = [name for name in (*STRATEGIES, *contributions()) if name != 'human']
    parser.add_argument('--strategy', nargs='+', default=['random_fsq', 'value_per_cost'], choices=strategies)
    parser.add_argument('--budget', type=NumberWithin(float, 0, 1e6), default=25.0)
    parser.add_argument('--turns', type=NumberWithin(int, 1, 10_000), default=40)
    parser.add_argument('--first', type=NumberWithin(int, 0, 1_000_000), default=1000)
    parser.add_argument('--samples', type=NumberWithin(int, 1, 100_000), default=20)
    parser.add_argument('--every', type=NumberWithin(int, 1, 10_000), default=5)
    parser.add_argument('--jobs', type=NumberWithin(int, 1, 1024), default=os.cpu_count())
    given = parser.parse_args()
    try:
        for task in given.task:
            load_task(task)
    except InputError as error:
        parser.error(str(error))
    samples = range(given.first, given.first + given.samples)
    cases = [
        Case(task, strategy, sample, given.budget, given.turns, given.every)
        for task, strategy, sample in itertools.product(given.task, given.strategy, samples)
    ]
    by_task: dict[str, list[Label]] = {task: [] for task in given.task}
    with ProcessPoolExecutor(given.jobs) as pool:
        for case, labels in zip(cases, pool.map(play, cases), strict=True):
            by_task[case.task] += labels
    columns = ['', *(f'{n[0]} examples' if len(n) == 1 else f'{n[0]} to {n[-1]}' for n in EXAMPLES[:-1]), '8 or more']
    print_table(
        'change of accuracy by one label, in thousandths',
        columns,
        list(itertools.chain(*itertools.starmap(gain_rows, by_task.items()))),
    )
    areas = []
    for task, labels in by_task.items():
        positive = [label.symbol != NO_SYMBOL for label in labels]
        if not all(positive):
            scores = [label.odds for label in labels], [label.belief for label in labels]
            areas.append([task, *(f'{area_under_curve(score, positive):.2f}' for score in scores)])
    print_table('of some symbol, or of none', ['', 'odds of the classifiers', 'beliefs'], areas)


if __name__ == '__main__':
    main()
