"""Strategies on data that are not ours: scikit-learn's digits, wine and breast cancer as things on a table.

    python benchmarks/other_data.py [--data NAME ...] [--strategy NAME ...] [--first SPLIT] [--splits N]
                                    [--budget B] [--turns T] [--jobs N] [--json FILE]

Half of the things, drawn by the number of the split, are held out. Of the others 20 lie in view, and all of them leave
at each change of the scene, every 10 turns; there is no clutter, and all groups of features are relevant. Printed are,
for each data set, the accuracy on the held-out things at the end of the time, its mean over the splits with the
standard error; and the difference to the best control that was played, with the standard error of the paired
differences, and p of Wilcoxon's one-tailed signed-rank test that the strategy is the better one, uncorrected.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from joblib import Parallel, delayed
from measuring import print_table
from sklearn.datasets import load_breast_cancer, load_digits, load_wine

from al_questioner.domain import InputError
from al_questioner.experiments.plan import CONTROLS
from al_questioner.experiments.statistics import best_of, mean_and_error, paired_p
from al_questioner.questioning import STRATEGIES
from al_questioner.questioning.strategies.names import contributions
from al_questioner.simulation import Pool, PoolWorld, ScriptedTeacher, episode_settings, run_episode
from al_questioner.support.arguments import NumberWithin
from al_questioner.support.arrays import Array

COMPARED = ('value_per_cost', 'u_sampling_fsq', 'farthest_fsq', 'random_fsq', 'typiclust', 'probcover')


class Case(NamedTuple):
    """One episode."""

    data: str
    split: int
    strategy: str
    budget: float
    turns: int


def digits() -> Pool:
    """Handwritten digits of 8 x 8 pixels; a group is a row of the picture."""
    data = load_digits()
    return Pool(data.data, data.target, [f'row{pixel // 8}_{pixel % 8}' for pixel in range(64)])


def wine() -> Pool:
    """Wines of three growers; each of the 13 measurements is a group."""
    data = load_wine()
    names = [name.replace('_', '-') for name in data.feature_names]
    return Pool(data.data, [data.target_names[target] for target in data.target], names)


def cancer() -> Pool:
    """Tumours, malignant or benign; a group is a property of cell nuclei: its mean, its error and its worst value."""
    data = load_breast_cancer()
    names = [cancer_feature(name) for name in data.feature_names]
    return Pool(data.data, [data.target_names[target] for target in data.target], names)


def cancer_feature(name: str) -> str:
    """Name with the property first: 'concave-points_error' for 'concave points error'."""
    words = name.split()
    statistic = next(word for word in ('mean', 'error', 'worst') if word in words)
    return f'{"-".join(word for word in words if word != statistic)}_{statistic}'


DATA: Mapping[str, Callable[[], Pool]] = {'digits': digits, 'wine': wine, 'cancer': cancer}


def play(case: Case) -> float:
    """Accuracy at the end of an episode."""
    world = PoolWorld(DATA[case.data](), case.split, name=case.data)
    settings = episode_settings(world.task, case.strategy, case.budget, case.turns)
    teacher = ScriptedTeacher(world.task.symbols, world.task.relevant_groups, case.split)
    return run_episode(world.spec, settings, teacher, world=world).final_accuracy


def rows_of(accuracies: Mapping[str, Array]) -> list[list[str]]:
    """A row for each strategy, of (n,) accuracies by split, beside the best control."""
    controls = {name: float(values.mean()) for name, values in accuracies.items() if name in CONTROLS}
    best = best_of(controls) if controls else ''
    rows = []
    for name, values in accuracies.items():
        mean, error = mean_and_error(values[:, None])
        row = [name, f'{mean[0]:.3f} ± {error[0]:.3f}', '', '']
        if best and name != best:
            difference, its_error = mean_and_error((values - accuracies[best])[:, None])
            row[2:] = f'{difference[0]:+.3f} ± {its_error[0]:.3f}', f'{paired_p(values, accuracies[best]):.4f}'
        rows.append(row)
    return rows


def main(arguments: Sequence[str] | None = None) -> int:
    """Play all episodes, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--data', nargs='+', default=list(DATA), choices=DATA)
    strategies = [name for name in (*STRATEGIES, *contributions()) if name != 'human']
    parser.add_argument('--strategy', nargs='+', default=list(COMPARED), choices=strategies)
    parser.add_argument('--first', type=NumberWithin(int, 0, 1_000_000), default=0, help='split (%(default)s)')
    parser.add_argument('--splits', type=NumberWithin(int, 1, 100_000), default=20)
    parser.add_argument('--budget', type=NumberWithin(float, 0, 1e6), default=25.0)
    parser.add_argument('--turns', type=NumberWithin(int, 1, 10_000), default=40)
    parser.add_argument('--jobs', type=NumberWithin(int, 1, 1024), default=2)
    parser.add_argument('--json', type=Path, metavar='FILE', help='write the accuracies of all episodes as JSON')
    given = parser.parse_args(arguments)
    splits = range(given.first, given.first + given.splits)
    cases = [
        Case(data, split, strategy, given.budget, given.turns)
        for data in dict.fromkeys(given.data)
        for split in splits
        for strategy in dict.fromkeys(given.strategy)
    ]
    try:
        played = dict(zip(cases, Parallel(given.jobs)(delayed(play)(case) for case in cases), strict=True))
    except InputError as error:
        print(f'other_data: {error}', file=sys.stderr)
        return 2
    if given.json is not None:
        rows = [{**case._asdict(), 'final_accuracy': accuracy} for case, accuracy in played.items()]
        given.json.write_text(json.dumps(rows, indent=1) + '\n', encoding='utf-8')
    columns = ['', 'accuracy, its error', 'to the best control, its error', 'Wilcoxon p']
    for data in dict.fromkeys(given.data):
        by_strategy = {
            strategy: np.array([played[Case(data, split, strategy, given.budget, given.turns)] for split in splits])
            for strategy in dict.fromkeys(given.strategy)
        }
        title = f'{data}, budget {given.budget:g}, {given.turns} turns, splits {splits[0]} to {splits[-1]}'
        print_table(title, columns, rows_of(by_strategy))
    return 0


if __name__ == '__main__':
    sys.exit(main())
