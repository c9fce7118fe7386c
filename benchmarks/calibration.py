"""Calibration of the classifiers' probabilities: how often what they say is right, by how sure they are.

    python benchmarks/calibration.py [--task TASK ...] [--strategy NAME] [--samples N] [--picture FILE]

A learner with each of several classifiers plays the same episodes in C1, and is then asked about the held-out things:
for the name of each, whose probability is the largest p(y|x), and for q_y(x), the probability that it is a y, of every
symbol. Printed are, as means over the samples, the accuracy, the mean probability of the name, the Brier score and the
logarithmic loss of p(y|x), and the expected calibration errors of the name and of the q_y(x): the mean difference of
probability and share over ten bins of the probability, weighted by what is in them. The picture shows both of all
samples together: probability and share in each bin.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from joblib import Parallel, delayed
from matplotlib import pyplot as plt
from measuring import calibration_error, print_table, reliability
from numpy.typing import NDArray

from al_questioner.domain import DEFAULT_CLASSIFIERS, Classifiers, InputError, random_stream
from al_questioner.experiments.plan import PAPER_CONDITIONS
from al_questioner.questioning import STRATEGIES, Episode
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task
from al_questioner.support.arguments import NumberWithin
from al_questioner.support.arrays import Array
from al_questioner.support.plotting import STYLE, put_legend_below, save

TASKS = ('prepare_lunch', 'pack_lunchbox', 'kitchen_table', 'mixed_kitchens')
COMPARED: Mapping[str, Classifiers] = {
    'RBF, no balance': Classifiers(kernel_shape='rbf', class_balance=0.0),
    'grouped, no balance': Classifiers(class_balance=0.0),
    'grouped, balance 0.5 (ships)': DEFAULT_CLASSIFIERS,
}
LEAST_PROBABILITY = 1e-12
"""Probability whose logarithm stands for that of 0."""


class Tested(NamedTuple):
    """The held-out things of an episode: (k, |Y|) q_y(x), and (k, |Y|) whether that is the symbol."""

    beliefs: Array
    truth: NDArray[np.bool_]

    @property
    def probabilities(self) -> Array:
        """(k, |Y|) p(y|x)."""
        normalised: Array = self.beliefs / self.beliefs.sum(axis=1, keepdims=True)
        return normalised

    @property
    def names(self) -> tuple[Array, NDArray[np.bool_]]:
        """(k,) probabilities of the names, and whether they are right."""
        rows, called = np.arange(len(self.truth)), self.beliefs.argmax(axis=1)
        return self.probabilities[rows, called], self.truth[rows, called]

    @property
    def binary(self) -> tuple[Array, NDArray[np.bool_]]:
        """(k |Y|,) q_y(x), and whether x is a y."""
        return self.beliefs.ravel(), self.truth.ravel()


def play(task_name: str, strategy: str, sample: int) -> list[Tested]:
    """Play an episode with each of the compared classifiers in the same world."""
    task = load_task(task_name).of_sample(sample)
    world = PerceivedWorld(WorldSpec(task, sample, sample).open())
    condition = PAPER_CONDITIONS['C1']
    tested = []
    for classifiers in COMPARED.values():
        settings = episode_settings(task, strategy, condition.budget, condition.turns, **classifiers._asdict())
        teacher = ScriptedTeacher(task.symbols, task.relevant_groups, sample)
        episode = Episode(settings, random_stream(sample, 'learner'))
        for turn in range(1, settings.turns + 1):
            query = episode.ask(world.scene(turn)).query
            if query is not None:
                episode.tell(teacher.answer(query, world.truth(turn)))
        features, symbols = world.test_set
        truth = np.array(symbols)[:, None] == np.array(settings.symbols)
        tested.append(Tested(episode.concepts.predict_proba(features), truth))
    return tested


def scores(tested: Tested) -> list[float]:
    """Accuracy, mean probability of the name, Brier score, logarithmic loss, and both calibration errors."""
    sure, right = tested.names
    true = np.maximum(tested.probabilities[tested.truth], LEAST_PROBABILITY)
    squares = ((tested.probabilities - tested.truth) ** 2).sum(axis=1)
    errors = calibration_error(sure, right), calibration_error(*tested.binary)
    return [float(value) for value in (right.mean(), sure.mean(), squares.mean(), -np.log(true).mean(), *errors)]


def draw(by_task: Mapping[str, Sequence[Sequence[Tested]]], path: Path) -> Path:
    """Draw two reliability diagrams for each task, of names and of q, with a line for each of the classifiers."""
    with plt.rc_context(STYLE):
        size = {'figsize': (3.4 * len(by_task), 7), 'squeeze': False, 'sharex': True, 'sharey': True}
        figure, panels = plt.subplots(2, len(by_task), **size)
        for column, (task, played) in zip(panels.T, by_task.items(), strict=True):
            column[0].set_title(task)
            for axes, of_kind in zip(column, (lambda tested: tested.names, lambda tested: tested.binary), strict=True):
                axes.plot([0, 1], [0, 1], color='grey', linewidth=1)
                for name, of_classifiers in zip(COMPARED, zip(*played, strict=True), strict=True):
                    sure, right = map(np.concatenate, zip(*map(of_kind, of_classifiers), strict=True))
                    axes.plot(*reliability(sure, right)[1:], marker='o', markersize=4, label=name)
        panels[0][0].set(ylabel='share of right names', xlim=(0, 1), ylim=(0, 1))
        panels[1][0].set_ylabel('share of things that are a y')
        for below, label in zip(panels, ('probability of the name', 'q of a symbol y'), strict=True):
            for axes in below:
                axes.set_xlabel(label)
        put_legend_below(figure, len(COMPARED), *panels[0][0].get_legend_handles_labels())
    return save(figure, path)


def main(arguments: Sequence[str] | None = None) -> int:
    """Play, print a table for each task, and draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--task', nargs='+', default=list(TASKS))
    parser.add_argument(
        '--strategy', default='value_per_cost', choices=[name for name in STRATEGIES if name != 'human']
    )
    parser.add_argument('--samples', type=NumberWithin(int, 1, 100_000), default=20, help='from 0 on (%(default)s)')
    parser.add_argument('--jobs', type=NumberWithin(int, 1, 1024), default=2)
    parser.add_argument('--picture', type=Path, metavar='FILE')
    given = parser.parse_args(arguments)
    cases = [(task, sample) for task in given.task for sample in range(given.samples)]
    try:
        played = Parallel(given.jobs)(delayed(play)(task, given.strategy, sample) for task, sample in cases)
        by_task = {
            task: [tested for (of, _), tested in zip(cases, played, strict=True) if of == task] for task in given.task
        }
        for task, of_samples in by_task.items():
            means = np.mean([[scores(tested) for tested in of_sample] for of_sample in of_samples], axis=0)
            columns = ['', 'accuracy', 'mean probability', 'Brier score', 'log loss', 'error of names', 'error of q']
            rows = [[name, *(f'{x:.3f}' for x in row)] for name, row in zip(COMPARED, means, strict=True)]
            print_table(f'{task}, {given.strategy}, C1, samples 0 to {given.samples - 1}', columns, rows)
        if given.picture is not None:
            print(draw(by_task, given.picture))
    except InputError as error:
        print(f'calibration: {error}', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
