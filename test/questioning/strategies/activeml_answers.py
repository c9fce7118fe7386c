"""Ask scikit-activeml what it would label in states of a fixed pool, and write its answers beside this file.

    python test/questioning/strategies/activeml_answers.py

It needs scikit-activeml (pip install scikit-activeml==1.0.1), which asks for newer numpy, joblib and scikit-learn than
Ubuntu 24.04 has; so it is no dependency of the tests, and they read the file.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

ANSWERS = Path(__file__).with_name('activeml_answers.json')
POINTS, LABELS = 60, 14
CLASSES, NEIGHBOURS, PURITY = 4, 20, 0.95
REPEATS = 12
"""Number of random states, which tell all answers among which it draws lots."""


def main() -> None:
    """Write the pool, and the states with their answers."""
    rng = np.random.default_rng(17)
    centres = rng.normal(0, 1, (5, 4))
    kinds = rng.choice(5, POINTS, p=[0.4, 0.25, 0.15, 0.1, 0.1])
    spreads = np.array([0.3, 0.6, 0.9, 0.5, 1.2])[kinds]
    points = np.round(centres[kinds] + spreads[:, None] * rng.normal(size=(POINTS, 4)), 3)
    labelled = [sorted(int(row) for row in rng.choice(POINTS, count, replace=False)) for count in range(1, LABELS)]
    content = {
        'points': points.tolist(),
        'typiclust': [typiclust(points, rows) for rows in followed(points) + labelled],
        'probcover': probcover(points, [[], *labelled]),
    }
    ANSWERS.write_text(json.dumps(content) + '\n', encoding='utf-8')


def followed(points: NDArray[np.float64]) -> list[list[int]]:
    """States of an episode in which whatever it asks for is labelled."""
    states: list[list[int]] = [[]]
    while len(states) < LABELS:
        states.append([*states[-1], typiclust(points, states[-1])['answers'][0]])
    return states


def typiclust(points: NDArray[np.float64], labelled: list[int]) -> dict[str, Any]:
    """A state, its clusters, and all points that TypiClust may ask about in it."""
    from skactiveml.pool import TypiClust
    from sklearn.cluster import KMeans

    options = {'random_state': 0, 'n_init': 4}
    clusters = KMeans(len(labelled) + 1, **options).fit_predict(points)
    answers = set()
    for seed in range(REPEATS):
        asks = TypiClust(random_state=seed, cluster_algo_dict=options, k=NEIGHBOURS)
        answers.add(int(asks.query(points, known(labelled))[0]))
    return {'labelled': labelled, 'clusters': clusters.tolist(), 'answers': sorted(answers)}


def probcover(points: NDArray[np.float64], states: list[list[int]]) -> dict[str, Any]:
    """The clusters and the radius of ProbCover, and in each state how many points each label would newly cover."""
    from scipy.spatial.distance import cdist
    from skactiveml.pool import ProbCover
    from sklearn.cluster import KMeans

    options = {'random_state': 0, 'n_init': 4}
    distances = cdist(points, points)
    asks = ProbCover(
        n_classes=CLASSES,
        # Every radius that makes a difference.
        deltas=np.unique(distances),
        alpha=PURITY,
        cluster_algo_dict=options,
        distance_func=lambda table: distances,
        random_state=0,
    )
    found = []
    for labelled in states:
        _, utilities = asks.query(points, known(labelled), return_utilities=True)
        found.append(
            {'labelled': labelled, 'covered': [None if np.isnan(value) else int(value) for value in utilities[0]]}
        )
    clusters = KMeans(CLASSES, **options).fit_predict(points)
    return {'clusters': clusters.tolist(), 'largest_distance': float(asks.delta_max_), 'states': found}


def known(labelled: list[int]) -> NDArray[np.float64]:
    """(n,) labels as scikit-activeml takes them, NaN for none; which they are is all the same to both."""
    labels = np.full(POINTS, np.nan)
    labels[labelled] = 0
    return labels


if __name__ == '__main__':
    main()
