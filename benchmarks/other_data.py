"""Strategies on data that are not ours: scikit-learn's digits, wine and breast cancer as things on a table.

    python benchmarks/other_data.py [--data NAME ...] [--strategy NAME ...] [--first SPLIT] [--splits N]
                                    [--budget B] [--turns T] [--jobs N] [--json FILE]

Half of the things, drawn by the number of the split, are held out. Of the others 20 lie in view, and all of them leave
at each change of the scene, every 10 turns; there is no clutter, and all groups of features are relevant. Printed are,
for each data set, the accuracies on the held-out things at the end of the time, and the tests of the first strategy
against each other one: `al_questioner.compare`.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

from sklearn.datasets import load_breast_cancer, load_digits, load_wine

from al_questioner.domain import InputError
from al_questioner.experiments.pool_comparison import PoolComparison, compare
from al_questioner.questioning import STRATEGIES
from al_questioner.questioning.strategies.names import contributions
from al_questioner.simulation import Pool
from al_questioner.support.arguments import NumberWithin

COMPARED = ('value_per_cost', 'u_sampling_fsq', 'farthest_fsq', 'random_fsq', 'typiclust', 'probcover')


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


def rows_of(found: PoolComparison) -> list[dict[str, object]]:
    """The accuracy at the end of each episode."""
    return [
        {
            'data': row.cell.task,
            'split': row.cell.sample,
            'strategy': row.cell.strategy,
            'budget': row.cell.budget,
            'turns': row.cell.turns,
            'final_accuracy': row.final_accuracy,
        }
        for row in found.results.episodes
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Play all episodes, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--data', nargs='+', default=list(DATA), choices=DATA)
    strategies = [name for name in (*STRATEGIES, *contributions(), 'all_labels') if name != 'human']
    parser.add_argument('--strategy', nargs='+', default=list(COMPARED), choices=strategies)
    parser.add_argument('--first', type=NumberWithin(int, 0, 1_000_000), default=0, help='split (%(default)s)')
    parser.add_argument('--splits', type=NumberWithin(int, 1, 100_000), default=20)
    parser.add_argument('--budget', type=NumberWithin(float, 0, 1e6), default=25.0)
    parser.add_argument('--turns', type=NumberWithin(int, 1, 10_000), default=40)
    parser.add_argument('--jobs', type=NumberWithin(int, 1, 1024), default=2)
    parser.add_argument('--json', type=Path, metavar='FILE', help='write the accuracies of all episodes as JSON')
    given = parser.parse_args(arguments)
    rows = []
    for data in dict.fromkeys(given.data):
        try:
            found = compare(
                list(dict.fromkeys(given.strategy)),
                DATA[data](),
                given.budget,
                repeats=given.splits,
                turns=given.turns,
                first_split=given.first,
                name=data,
                jobs=given.jobs,
            )
        except InputError as error:
            print(f'other_data: {error}', file=sys.stderr)
            return 2
        print(f'{found}\n')
        rows += rows_of(found)
    if given.json is not None:
        given.json.write_text(json.dumps(rows, indent=1) + '\n', encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
