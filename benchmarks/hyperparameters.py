"""Worth of another amplitude or kernel shape: episodes with and without it, in pairs.

    python benchmarks/hyperparameters.py [--task TASK ...] [--strategy STRATEGY ...] [--amplitude A ...]
                                         [--kernel-shape SHAPE ...] [--budget B] [--turns T] [--first SEED]
                                         [--samples N] [--jobs N]

Every episode is played with the classifiers that ship, and with each amplitude A under each kernel shape, on the same
sample, scenes and seed. A row holds, for the final accuracy and for its mean over the turns: what it is with the
classifiers that ship, the mean change with its standard error over the pairs, and the two-sided p-value of Wilcoxon's
signed-rank test.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from measuring import print_table
from scipy.stats import wilcoxon

from al_questioner.domain import AMPLITUDE, KERNEL_SHAPE
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
STRATEGIES_PLAYED = ('u_sampling_fsq', 'farthest_fsq', 'value_per_cost')
COLUMNS = ('', 'with', 'final', 'change', 'p', 'mean', 'change', 'p')


class Kernel(NamedTuple):
    """The kernel of an episode."""

    amplitude: float = AMPLITUDE.default
    shape: str = KERNEL_SHAPE.default

    def __str__(self) -> str:
        return f'{self.shape} {self.amplitude:g}'


class Case(NamedTuple):
    """One episode."""

    task: str
    strategy: str
    sample: int
    budget: float
    turns: int
    kernel: Kernel = Kernel()


class Outcome(NamedTuple):
    """Accuracy of an episode."""

    final: float
    mean: float


@lru_cache(maxsize=1)
def opened(task: str, sample: int) -> PerceivedWorld:
    """A world that the episodes on it share, so that its views are drawn and measured once."""
    return PerceivedWorld(WorldSpec(load_task(task), sample, sample).open())


def play(case: Case) -> Outcome:
    """Play an episode, world and learner drawing from the seed of the sample."""
    task = load_task(case.task)
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, case.sample, repeat_shown=True)
    settings = episode_settings(
        task,
        case.strategy,
        case.budget,
        case.turns,
        amplitude=case.kernel.amplitude,
        kernel_shape=case.kernel.shape,
    )
    world_spec = WorldSpec(task, case.sample, case.sample)
    result = run_episode(world_spec, settings, teacher, world=opened(case.task, case.sample))
    return Outcome(result.final_accuracy, statistics.mean(result.accuracy))


def play_all(cases: Sequence[Case]) -> dict[Case, Outcome]:
    """Play episodes one after the other."""
    return {case: play(case) for case in cases}


def change(without: Sequence[float], changed: Sequence[float]) -> list[str]:
    """Mean of the first, mean and standard error of the change, and the p-value."""
    # Rounded, as equal accuracies that were averaged in another order are ties.
    difference = np.round(np.subtract(changed, without), 12)
    p = wilcoxon(difference).pvalue if difference.any() else 1.0
    error = difference.std(ddof=1) / np.sqrt(len(difference))
    return [f'{np.mean(without):.3f}', f'{difference.mean():+.3f} ± {error:.3f}', f'{p:.3f}']


def row(name: str, kernel: Kernel, without: Sequence[Outcome], changed: Sequence[Outcome]) -> list[str]:
    """A line of the table."""
    final = change([o.final for o in without], [o.final for o in changed])
    mean = change([o.mean for o in without], [o.mean for o in changed])
    return [name, f'{kernel}', *final, *mean]


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--task', nargs='+', default=TASKS)
    parser.add_argument('--strategy', nargs='+', default=STRATEGIES_PLAYED, choices=(*STRATEGIES, *contributions()))
    parser.add_argument('--amplitude', nargs='+', type=float, default=[30.0, 300.0])
    parser.add_argument('--kernel-shape', nargs='+', default=[KERNEL_SHAPE.default], choices=KERNEL_SHAPE.choices)
    parser.add_argument('--budget', type=float, default=25)
    parser.add_argument('--turns', type=int, default=40)
    parser.add_argument('--first', type=int, default=1000, help='first seed')
    parser.add_argument('--samples', type=int, default=12)
    parser.add_argument('--jobs', type=int, default=1)
    given = parser.parse_args()
    samples = range(given.first, given.first + given.samples)
    groups = [
        [Case(task, strategy, sample, given.budget, given.turns) for sample in samples]
        for task, strategy in itertools.product(given.task, given.strategy)
    ]
    kernels = [Kernel(*each) for each in itertools.product(given.amplitude, given.kernel_shape)]
    plain = [case for group in groups for case in group]
    worlds: dict[tuple[str, int], list[Case]] = {}
    for case in [*plain, *(case._replace(kernel=kernel) for kernel in kernels for case in plain)]:
        worlds.setdefault((case.task, case.sample), []).append(case)
    outcomes: dict[Case, Outcome] = {}
    with ProcessPoolExecutor(given.jobs) as pool:
        for played in pool.map(play_all, worlds.values()):
            outcomes |= played

    rows = []
    for kernel in kernels:
        for group in (*groups, plain):
            name = 'all' if group is plain else f'{group[0].task} {group[0].strategy}'
            changed = [outcomes[case._replace(kernel=kernel)] for case in group]
            rows.append(row(name, kernel, [outcomes[case] for case in group], changed))
        rows.append([])
    title = f'{Kernel()}, budget {given.budget:g}, {given.turns} turns, seeds {samples.start} to {samples.stop - 1}'
    print_table(title, COLUMNS, rows)


if __name__ == '__main__':
    main()
