"""Worth of re-optimising the kernel's amplitude and length scale: paired episodes with and without it.

    python benchmarks/hyperparameters.py [--task TASK ...] [--strategy STRATEGY ...] [--tune-every K ...]
                                         [--amplitude A] [--budget B] [--turns T] [--first SEED] [--samples N]
                                         [--grid]

Every episode is played with tune_every 0 and with each K, on the same sample, scenes and seed. A row holds, for the
final accuracy and for its mean over the turns: what it is without, the mean change with its deviation over the pairs,
and the two-sided p-value of Wilcoxon's signed-rank test; then the median amplitude and length scale after the last
turn. --tune-every 0 --amplitude A compares with another amplitude that stays. With --grid a row holds the changes over
all tasks and strategies given under several bounds and priors: to choose them, on other seeds than those reported.
"""

from __future__ import annotations

import argparse
import itertools
import os
import statistics
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from measuring import median_and_spread, print_table
from scipy.stats import wilcoxon

from al_questioner.concepts.laplace import hyperparameters
from al_questioner.questioning import STRATEGIES
from al_questioner.questioning.strategies.names import contributions
from al_questioner.simulation import (
    PerceivedWorld,
    ScriptedTeacher,
    WorldSpec,
    episode_settings,
    load_task,
    run_episode,
)

TASKS = ('prepare_lunch', 'kitchen_table', 'pack_lunchbox')
FAST_STRATEGIES = ('u_sampling_fsq', 'farthest_fsq', 'rarest_demo')
COLUMNS = ('', 'every', 'final without', 'change', 'p', 'mean without', 'change', 'p', 'amplitude', 'length scale')


class Prior(NamedTuple):
    """Factors within which amplitude and length scale may move, and deviations of their logarithms."""

    amplitude_factor: float
    length_scale_factor: float
    amplitude_deviation: float
    length_scale_deviation: float


SHIPPED = Prior(
    hyperparameters.AMPLITUDE_FACTOR, hyperparameters.LENGTH_SCALE_FACTOR, *hyperparameters.PRIOR_DEVIATIONS.tolist()
)
GRID = (
    Prior(4, 3, np.inf, np.inf),
    Prior(4, 3, 1.0, 0.5),
    Prior(4, 3, 0.5, 0.25),
    Prior(4, 3, 0.25, 0.5),
    Prior(4, 2, 1.0, 0.25),
    Prior(25, 10, np.inf, np.inf),
)
"""Priors that --grid tries; an infinite deviation is no prior."""


class Case(NamedTuple):
    """One episode."""

    task: str
    strategy: str
    sample: int
    budget: float
    turns: int
    tune_every: int
    prior: Prior = SHIPPED
    amplitude: float = 4.0


class Outcome(NamedTuple):
    """Accuracy and kernel of an episode."""

    final: float
    mean: float
    amplitude: float
    length_scale: float


@lru_cache(maxsize=1)
def opened(task: str, sample: int) -> PerceivedWorld:
    """A world that the episodes on it share, so that its views are drawn and measured once."""
    return PerceivedWorld(WorldSpec(load_task(task), sample, sample).open())


def play(case: Case) -> Outcome:
    """Play an episode, world and learner drawing from the seed of the sample."""
    hyperparameters.AMPLITUDE_FACTOR = case.prior.amplitude_factor
    hyperparameters.LENGTH_SCALE_FACTOR = case.prior.length_scale_factor
    hyperparameters.PRIOR_DEVIATIONS = np.array(case.prior[2:])
    task = load_task(case.task)
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, case.sample, repeat_shown=True)
    settings = episode_settings(
        task, case.strategy, case.budget, case.turns, amplitude=case.amplitude, tune_every=case.tune_every
    )
    world_spec = WorldSpec(task, case.sample, case.sample)
    result = run_episode(world_spec, settings, teacher, world=opened(case.task, case.sample))
    return Outcome(
        result.final_accuracy, statistics.mean(result.accuracy), result.kernel.amplitude, result.kernel.length_scale
    )


def play_all(cases: Sequence[Case]) -> dict[Case, Outcome]:
    """Play episodes one after the other."""
    return {case: play(case) for case in cases}


def change(without: Sequence[float], tuned: Sequence[float]) -> list[str]:
    """Mean of the first, mean and deviation of the change, and the p-value."""
    # Rounded, as equal accuracies that were averaged in another order are ties.
    difference = np.round(np.subtract(tuned, without), 12)
    p = wilcoxon(difference).pvalue if difference.any() else 1.0
    return [f'{np.mean(without):.3f}', f'{difference.mean():+.3f} ± {difference.std(ddof=1):.3f}', f'{p:.3f}']


def row(name: str, every: int, without: Sequence[Outcome], tuned: Sequence[Outcome]) -> list[str]:
    """A line of the table."""
    final = change([o.final for o in without], [o.final for o in tuned])
    mean = change([o.mean for o in without], [o.mean for o in tuned])
    amplitude = median_and_spread([o.amplitude for o in tuned])[0]
    length_scale = median_and_spread([o.length_scale for o in tuned])[0]
    return [name, f'{every}', *final, *mean, f'{amplitude:.2f}', f'{length_scale:.2f}']


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--task', nargs='+', default=TASKS)
    parser.add_argument('--strategy', nargs='+', default=FAST_STRATEGIES, choices=(*STRATEGIES, *contributions()))
    parser.add_argument('--tune-every', nargs='+', type=int, default=[5, 10])
    parser.add_argument('--amplitude', type=float, default=4.0, help='configured where K applies (%(default)s)')
    parser.add_argument('--budget', type=float, default=25)
    parser.add_argument('--turns', type=int, default=40)
    parser.add_argument('--first', type=int, default=0, help='first seed')
    parser.add_argument('--samples', type=int, default=10)
    parser.add_argument('--grid', action='store_true')
    given = parser.parse_args()
    samples = range(given.first, given.first + given.samples)
    groups = [
        [Case(task, strategy, sample, given.budget, given.turns, 0) for sample in samples]
        for task, strategy in itertools.product(given.task, given.strategy)
    ]

    def changed(case: Case, prior: Prior, every: int) -> Case:
        return case._replace(prior=prior, tune_every=every, amplitude=given.amplitude)

    priors = GRID if given.grid else (SHIPPED,)
    variants = list(itertools.product(priors, given.tune_every))
    plain = [case for group in groups for case in group]
    cases = [*plain, *(changed(case, p, k) for p, k in variants for case in plain)]
    worlds: dict[tuple[str, int], list[Case]] = {}
    for case in cases:
        worlds.setdefault((case.task, case.sample), []).append(case)
    outcomes: dict[Case, Outcome] = {}
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        for played in pool.map(play_all, worlds.values()):
            outcomes |= played

    rows = []
    for prior, every in variants:
        for group in (plain,) if given.grid else (*groups, plain):
            name = 'all' if group is plain else f'{group[0].task} {group[0].strategy}'
            if given.grid:
                name = f'factors {prior[:2]}, deviations {prior[2:]}'
            tuned = [outcomes[changed(case, prior, every)] for case in group]
            rows.append(row(name, every, [outcomes[case] for case in group], tuned))
        if not given.grid:
            rows.append([])
    title = f'budget {given.budget:g}, {given.turns} turns, seeds {samples.start} to {samples.stop - 1}'
    print_table(title, COLUMNS, rows)


if __name__ == '__main__':
    main()
