"""Difficulty of each simulated world: the worth of labels and features in it.

    python benchmarks/difficulty.py [--task TASK ...] [--samples N]

For each task, over N samples (seeds 0 to N - 1), the accuracy on held-out observations of a learner that was told
all labels, or 25 labels drawn at random, with all features or with those that the scripted teacher calls relevant.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Iterator

import numpy as np

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import NO_SYMBOL, Scene, random_stream
from al_questioner.perception import perceive
from al_questioner.questioning import new_concept_learner
from al_questioner.simulation import Task, World, WorldSpec, accuracy, episode_settings, load_task

LABELS = 25
POOL = 400
"""Observations of a training pool that are looked at, at most; a Gaussian process of thousands takes minutes."""


def test_set(world: World) -> tuple[np.ndarray, tuple[str, ...]]:
    """At most `POOL` test observations, evenly spread."""
    observations, labels = world.test_observations(), world.test_labels()
    chosen = range(0, len(labels), max(1, len(labels) // POOL))
    scenes = [perceive([observations[i]]).features for i in chosen]
    return np.concatenate(scenes), tuple(labels[i] for i in chosen)


def told(task: Task, pool: Scene, labels: list[str], rows: list[int], with_subset: bool) -> ConceptLearner:
    """A learner that saw the whole pool and was told the labels of some rows."""
    concepts = new_concept_learner(episode_settings(task), None)
    concepts.observe(pool)
    if with_subset:
        concepts.restrict_to_groups(task.relevant_groups)
    concepts.label_scene(pool, {pool.object_ids[row]: labels[row] for row in rows}, 1)
    return concepts


def measure(task: Task, sample: int) -> Iterator[tuple[str, float]]:
    """Each figure of one sample, by name."""
    start = time.perf_counter()
    world = WorldSpec(task, sample, sample).open()
    all_labels = world.training_labels()
    chosen = sorted(random_stream(sample, 'calibration/pool').permutation(len(all_labels))[:POOL].tolist())
    pool = perceive(world.training_pool(chosen))
    labels = [all_labels[i] for i in chosen]
    features, truth = test_set(world)
    yield 'seconds to make', time.perf_counter() - start
    some = random_stream(sample, 'calibration/labels').permutation(len(labels))[:LABELS].tolist()
    for name, rows in (('all labels', list(range(len(labels)))), (f'{LABELS} labels', some)):
        for with_subset in (False, True):
            concepts = told(task, pool, labels, rows, with_subset)
            value = accuracy(concepts.predict_proba(features), truth, task.symbols)
            yield f'{name}, {"relevant" if with_subset else "all"} features', value
    yield 'share of clutter', labels.count(NO_SYMBOL) / len(labels)


def main() -> None:
    """Print a table for each task."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--task', nargs='+', default=['prepare_lunch', 'kitchen_table', 'pack_lunchbox'])
    parser.add_argument('--samples', type=int, default=5)
    given = parser.parse_args()
    for name in given.task:
        task = load_task(name)
        figures: dict[str, list[float]] = {}
        for sample in range(given.samples):
            for figure, value in measure(task, sample):
                figures.setdefault(figure, []).append(value)
        print(f'\n{name}, {given.samples} samples')
        for figure, values in figures.items():
            spread = statistics.stdev(values) if len(values) > 1 else 0.0
            print(f'  {figure:<32} {statistics.mean(values):6.3f}  +/- {spread:.3f}')


if __name__ == '__main__':
    main()
