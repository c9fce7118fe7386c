"""Imitation of experts that weights were not trained on, and behaviour of these weights with other budgets and times.

    python benchmarks/imitation.py [BAG ...] [--demonstrations N] [--samples N] [--jobs N] [--seed SEED]

The weights are learnt from the bags (those of bags/) by both methods and held against N demonstrations of the scripted
expert with other seeds, beside weights set by hand, all weights equal to zero (a uniform policy), and never asking.
Log-likelihoods are of a softmax whose one scale is fitted to the bags, for every row alike. gap: length of the expert's
minus the learner's feature counts, in units of the features' spread, the learner playing each held-out episode itself.
The second table tells what a learner with the weights does in other conditions, over N samples. All have the
classifiers that learners have by default; the choices in the bags are as they were recorded.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from al_questioner.support.arrays import Array

os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from measuring import print_table

from al_questioner.domain import DECISION_FEATURES, DEFAULT_CLASSIFIERS, EpisodeSettings, QueryKind
from al_questioner.imitation.assessment import Imitation, agreement, imitate
from al_questioner.imitation.bags import read_demonstrations
from al_questioner.imitation.choice_likelihood import fit_temperature
from al_questioner.imitation.demonstration import Demonstration, all_steps, feature_scale
from al_questioner.imitation.settings import MatchingSettings, TrainingSettings
from al_questioner.imitation.training import train
from al_questioner.questioning import read_weights
from al_questioner.simulation import (
    PerceivedWorld,
    ScriptedTeacher,
    WorldSpec,
    episode_settings,
    load_task,
    run_episode,
)
from al_questioner.support.configuration import config_dir
from demonstrating import demonstrate

CONDITIONS = ((15, 30), (25, 40), (25, 150), (500, 40), (500, 150))
FIRST_HELD_OUT = 100
BAGS = [Path(__file__).resolve().parents[1] / 'bags' / f'expert_{number}' for number in range(3)]
NEVER = -1e6 * np.eye(7)[DECISION_FEATURES.index('budget_consumption')]


def by_hand() -> Array:
    """(7,) the weights that were set by hand."""
    named = read_weights(config_dir() / 'weights' / 'dt_task_env_by_hand.yaml').values
    return np.array([named[name] for name in DECISION_FEATURES])


def held_out(like: EpisodeSettings, task_name: str, count: int) -> list[tuple[Demonstration, PerceivedWorld]]:
    """Demonstrations of the expert with other seeds, under the same limits, and their worlds."""
    task = load_task(task_name)
    found = []
    for seed in range(FIRST_HELD_OUT, FIRST_HELD_OUT + count):
        world_spec = WorldSpec(task, seed, seed)
        world = PerceivedWorld(world_spec.open())
        teacher = ScriptedTeacher(task.symbols, task.relevant_groups, seed, repeat_shown=True)
        found.append((demonstrate(world_spec, like, teacher, world), world))
    return found


def imitation_rows(
    policies: Mapping[str, Array],
    shown: Sequence[Demonstration],
    others: Sequence[tuple[Demonstration, PerceivedWorld]],
) -> list[list[str]]:
    """A row for each policy."""
    steps, scale = list(all_steps(shown)), feature_scale(shown)
    demonstrations = [demonstration for demonstration, _ in others]
    rows = []
    for name, weights in policies.items():
        factor = fit_temperature(weights, steps) if weights.any() else 0.0
        found = agreement(weights * factor, demonstrations)
        # The scale matters to the softmax alone, but a scale of 0 would make the learner guess.
        chosen = agreement(weights, demonstrations)
        imitations = [imitate(weights, demonstration, world) for demonstration, world in others]
        gap = np.linalg.norm(count_gap(imitations, demonstrations, scale))
        likelihood = '-inf' if weights is NEVER else f'{found.log_likelihood:.2f}'
        rows.append([name, likelihood, f'{chosen.kind:.2f}', f'{chosen.ask:.2f}', f'{chosen.choice:.2f}', f'{gap:.1f}'])
    return rows


def count_gap(imitations: Sequence[Imitation], demonstrations: Sequence[Demonstration], scale: Array) -> Array:
    """Return expert's minus learner's feature counts, (F,), means over the episodes, in units of the scale (F,)."""
    expert = np.mean([demonstration.feature_counts for demonstration in demonstrations], axis=0)
    learner = np.mean([imitation.feature_counts for imitation in imitations], axis=0)
    return np.asarray(np.divide(expert - learner, scale, out=np.zeros_like(scale), where=scale > 0))


def condition_rows(policies: Mapping[str, Array], task_name: str, samples: int) -> list[list[str]]:
    """A row for each policy and condition."""
    task = load_task(task_name)
    worlds = {sample: PerceivedWorld(WorldSpec(task, sample, sample).open()) for sample in range(samples)}
    rows = []
    for name, weights in policies.items():
        for budget, turns in CONDITIONS:
            settings = dataclasses.replace(
                episode_settings(task, 'dt_task_env', budget, turns),
                weights=dict(zip(DECISION_FEATURES, map(float, weights), strict=True)),
            )
            results = []
            for sample, world in worlds.items():
                teacher = ScriptedTeacher(task.symbols, task.relevant_groups, sample, repeat_shown=True)
                results.append(run_episode(WorldSpec(task, sample, sample), settings, teacher, world=world))
            queries = [len(result.queries) for result in results]
            subset = [
                next((str(q.turn) for q in result.queries if q.kind is QueryKind.FEATURE_SUBSET), 'never')
                for result in results
            ]
            last = [max((q.turn for q in result.queries), default=0) for result in results]
            asked, spent = f'{min(queries)} to {max(queries)}', f'{max(result.spent for result in results):g}'
            accuracy = f'{np.mean([result.final_accuracy for result in results]):.3f}'
            cells = [asked, spent, ' '.join(subset), f'{min(last)} to {max(last)}', accuracy]
            rows.append([name, f'{budget} / {turns}', *cells])
    return rows


def main() -> None:
    """Print both tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or '').split('\n', 1)[0])
    parser.add_argument('bags', nargs='*', type=Path, default=BAGS)
    parser.add_argument('--demonstrations', type=int, default=10, help='held-out ones (%(default)s)')
    parser.add_argument('--samples', type=int, default=5, help='of the second table (%(default)s)')
    parser.add_argument('--jobs', type=int, default=os.cpu_count() or 1, help='processes of maxent (%(default)s)')
    parser.add_argument('--seed', type=int, default=0, help='of the rollouts (%(default)s)')
    given = parser.parse_args()
    shown = read_demonstrations(given.bags, classifiers=DEFAULT_CLASSIFIERS._asdict())
    matching = MatchingSettings(seed=given.seed, jobs=given.jobs)
    learnt = {
        method: train(shown, TrainingSettings(method, matching=matching)).weights for method in ('maxent', 'choice')
    }
    policies = {**learnt, 'by hand': by_hand(), 'uniform': np.zeros(7), 'never ask': NEVER}
    others = held_out(shown[0].settings, shown[0].task_name, given.demonstrations)
    print_table(
        f'{given.demonstrations} held-out demonstrations',
        ['weights', 'log-likelihood a turn', 'kind', 'whether to ask', 'candidate', 'gap'],
        imitation_rows(policies, shown, others),
    )
    print()
    print_table(
        f'{given.samples} samples',
        ['weights', 'budget / turns', 'queries', 'most spent', 'FSQ in turn', 'last query', 'accuracy'],
        condition_rows(
            {name: policies[name] for name in ('maxent', 'choice', 'by hand')}, shown[0].task_name, given.samples
        ),
    )


if __name__ == '__main__':
    main()
