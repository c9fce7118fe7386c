"""Recognition on tables that the learner has not seen: how often it is right, how sure it is, and whether it is so.

    python benchmarks/recognition.py [--task TASK ...] [--strategy NAME ...] [--condition C1] [--picture FILE]
    python benchmarks/recognition.py --fit

Each learner is taught in an episode, and then recognises what is on held-out tables of its task. Where a task has no
clutter, the tables are shown once as they are, and once with clutter from the kitchen table, a quarter of the things,
which nothing has prepared the learner for. Printed are, over all things of all samples:

- right: the share of things whose most probable symbol, or none, is the true one;
- precision and recall: of the names that are given (where a symbol is the most probable, with the probability of the
  threshold or more) the share that is right, and of the things of some symbol the share that is named rightly;
- calibration error of the most probable, and of none: the mean difference of probability and share over ten bins;
- the same of the largest q_y alone, with none where it is below a threshold: the threshold, of .40, .41 ... .95, with
  which most things of this very line are right. Nobody can know it before, so this is more than a rule could reach.

With --fit the constants of the probabilities are chosen: those that make what is true the most probable, on average
over samples 1000 to 1023 of all tasks, several strategies, and turns from the eighth on.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from joblib import Parallel, delayed
from matplotlib import rc_context
from measuring import calibration_error, print_table, reliability
from numpy.typing import NDArray
from scipy.optimize import minimize

from al_questioner.concepts.recognition import Calibration, Evidence, Recogniser, weigh
from al_questioner.domain import NO_SYMBOL, THRESHOLD, InputError, Scene, random_stream
from al_questioner.experiments.plan import PAPER_CONDITIONS
from al_questioner.perception import perceive
from al_questioner.questioning import STRATEGIES, Episode
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task
from al_questioner.support.arguments import NumberWithin
from al_questioner.support.arrays import Array
from al_questioner.support.plotting import STYLE, new_figure, put_legend_below, save

TASKS = ('prepare_lunch', 'pack_lunchbox', 'kitchen_table', 'mixed_kitchens')
CLUTTERED = 'kitchen_table'
TABLES = 3
"""Held-out tables of each sample."""
ADDED_SHARE = 0.25
CANDIDATE_THRESHOLDS = np.arange(0.40, 0.955, 0.01)
PANELS_PER_ROW = 3
NAMES = ('precision', 'recall')
FIT_SAMPLES = range(1000, 1024)
FIT_BOUNDS = ((0.1, 10), (-10, 2), (0.1, 10))
"""Of the sharpness, the logarithm of the weight of none, and the steepness."""
FIT_TURNS = (8, 20, 40, 80, 150)
FIT_EPISODES = (('value_per_cost', 'C1'), ('value_per_cost', 'C2'), ('rarest_demo', 'C1'))


class Shown(NamedTuple):
    """Things of some tables: their features, (k, m), and (k,) places of their symbols, the last of them none."""

    features: Array
    truth: NDArray[np.intp]


class Seen(NamedTuple):
    """Things and what a learner made of them."""

    evidence: Evidence
    truth: NDArray[np.intp]


def show(task_name: str, sample: int) -> dict[str, Shown]:
    """Return the things of held-out tables: as they are, and with clutter where the task has none."""
    task = load_task(task_name).of_sample(sample)
    world = PerceivedWorld(WorldSpec(task, sample, sample).open())
    names = (*task.symbols, NO_SYMBOL)
    tables = [world.new_table(number) for number in range(TABLES)]
    truth = [names.index(table.symbols[i]) for scene, table in tables for i in scene.object_ids]
    features = np.concatenate([scene.features for scene, _ in tables])
    shown = {task_name: Shown(features, np.array(truth))}
    if task.scenes.clutter_share == 0:
        count = round(len(truth) * ADDED_SHARE / (1 - ADDED_SHARE))
        added = _clutter(sample).features[:count]
        of_none = np.full(len(added), len(task.symbols))
        shown[f'{task_name}, clutter added'] = Shown(np.concatenate([features, added]), np.append(truth, of_none))
    return shown


def _clutter(sample: int) -> Scene:
    """Return what is of no symbol on a held-out kitchen table."""
    task = load_task(CLUTTERED).of_sample(sample)
    table = WorldSpec(task, sample, sample).open().new_table()
    return perceive([each for each in table.observations if table.symbols[each.object_id] == NO_SYMBOL])


def play(task_name: str, strategy: str, condition: str, sample: int, turns: Sequence[int]) -> list[dict[str, Seen]]:
    """Play an episode, and return what is made of the tables after each of these turns of it."""
    task = load_task(task_name).of_sample(sample)
    world = PerceivedWorld(WorldSpec(task, sample, sample).open())
    limits = PAPER_CONDITIONS[condition]
    settings = episode_settings(task, strategy, limits.budget, limits.turns)
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, sample)
    episode, shown, found = Episode(settings, random_stream(sample, 'learner')), show(task_name, sample), []
    for turn in range(1, settings.turns + 1):
        query = episode.ask(world.scene(turn)).query
        if query is not None:
            episode.tell(teacher.answer(query, world.truth(turn)))
        if turn in turns:
            recogniser = Recogniser(episode.concepts)
            found.append({name: Seen(recogniser.evidence(each.features), each.truth) for name, each in shown.items()})
    return found


def scores(seen: Sequence[Seen]) -> list[str]:
    """Return the columns of a line of the table, see above."""
    probabilities, truth = _probabilities(seen), np.concatenate([each.truth for each in seen])
    none = probabilities.shape[1] - 1
    best, sure = probabilities.argmax(axis=1), probabilities.max(axis=1)
    precision, recall = _precision_and_recall((best < none) & (sure >= THRESHOLD.default), best, truth, none)
    errors = calibration_error(sure, best == truth), calibration_error(probabilities[:, -1], truth == none)
    log_odds = np.concatenate([each.evidence.log_odds for each in seen])
    called, q = log_odds.argmax(axis=1), 1 / (1 + np.exp(-log_odds.max(axis=1)))
    right = [np.mean(np.where(q >= threshold, called, none) == truth) for threshold in CANDIDATE_THRESHOLDS]
    threshold = CANDIDATE_THRESHOLDS[int(np.argmax(right))]
    theirs = _precision_and_recall(q >= threshold, called, truth, none)
    numbers = [np.mean(best == truth), precision, recall, *errors, max(right), *theirs]
    return [*(f'{number:.3f}' for number in numbers), f'{threshold:.2f}']


def _precision_and_recall(
    named: NDArray[np.bool_], names: NDArray[np.intp], truth: NDArray[np.intp], none: int
) -> tuple[float, float]:
    right = named & (names == truth)
    return float(right.sum() / max(named.sum(), 1)), float(right.sum() / max((truth < none).sum(), 1))


def _probabilities(seen: Sequence[Seen], calibration: Calibration | None = None) -> Array:
    return np.concatenate([weigh(each.evidence, calibration or Calibration()) for each in seen])


def fit(jobs: int) -> Calibration:
    """Return the constants under which what is true is the most probable, with equal weights of learners."""
    cases = [(task, *episode, sample) for task in TASKS for episode in FIT_EPISODES for sample in FIT_SAMPLES]
    played = Parallel(jobs)(delayed(play)(*case, FIT_TURNS) for case in cases)
    # Where clutter was added, the things without it are among the others.
    learners = [list(each.values())[-1] for of_episode in played for each in of_episode]
    evidence = Evidence(*map(np.concatenate, zip(*(each.evidence for each in learners), strict=True)))
    truth = np.concatenate([each.truth for each in learners])
    weights = np.concatenate([np.full(len(each.truth), 1 / len(each.truth)) for each in learners]) / len(learners)

    def with_values(values: Array) -> Calibration:
        sharpness, log_weight, steepness = map(float, values)
        return Calibration(sharpness=sharpness, none_weight=float(np.exp(log_weight)), steepness=steepness)

    def loss(values: Array) -> float:
        probabilities = weigh(evidence, with_values(values))
        return -float(weights @ np.log(probabilities[np.arange(len(truth)), truth]))

    found = minimize(loss, [1.0, -1.0, 1.0], method='L-BFGS-B', bounds=FIT_BOUNDS)
    calibration = with_values(found.x)
    print(f'{len(learners)} learners, {len(truth)} things; mean logarithmic loss {found.fun:.4f} with')
    print(', '.join(f'{name} {value:.3f}' for name, value in calibration._asdict().items()))
    ours = Calibration()
    print(f'{loss(np.array([ours.sharpness, np.log(ours.none_weight), ours.steepness])):.4f} with what ships')
    return calibration


def draw(by_table: Mapping[str, Sequence[Seen]], path: Path) -> Path:
    """Draw a reliability diagram for each kind of table: of the most probable, and of none."""
    with rc_context(STYLE):
        rows = -(-len(by_table) // PANELS_PER_ROW)
        figure = new_figure(3 * PANELS_PER_ROW, 3.2 * rows + 0.4)
        panels = figure.subplots(rows, PANELS_PER_ROW, squeeze=False, sharex=True, sharey=True).ravel()
        for axes in panels[len(by_table) :]:
            axes.set_axis_off()
        for axes, (name, seen) in zip(panels, by_table.items(), strict=False):
            probabilities, truth = _probabilities(seen), np.concatenate([each.truth for each in seen])
            none = probabilities.shape[1] - 1
            axes.plot([0, 1], [0, 1], color='grey', linewidth=1)
            curves: Iterator[tuple[str, Array, NDArray[np.bool_]]] = iter(
                (
                    ('the most probable', probabilities.max(axis=1), probabilities.argmax(axis=1) == truth),
                    ('none', probabilities[:, -1], truth == none),
                )
            )
            for label, sure, right in curves:
                counts, mean, share = reliability(sure, right)
                (line,) = axes.plot(mean, share, linewidth=1, label=label)
                axes.scatter(mean, share, s=4 + 120 * counts / counts.sum(), color=line.get_color())
            axes.set_title(name, fontsize=10)
            axes.set(xlabel='probability', xlim=(0, 1), ylim=(0, 1))
        for axes in panels[::PANELS_PER_ROW]:
            axes.set_ylabel('share that is right')
        put_legend_below(figure, 2, *panels[0].get_legend_handles_labels())
    return save(figure, path)


def main(arguments: Sequence[str] | None = None) -> int:
    """Play, print a table for each strategy, and draw; or choose the constants."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--task', nargs='+', default=list(TASKS))
    names = [name for name in STRATEGIES if name != 'human']
    parser.add_argument('--strategy', nargs='+', default=['value_per_cost'], choices=names)
    parser.add_argument('--condition', default='C1', choices=list(PAPER_CONDITIONS))
    parser.add_argument('--samples', type=NumberWithin(int, 1, 100_000), default=20, help='from 0 on (%(default)s)')
    parser.add_argument('--jobs', type=NumberWithin(int, 1, 1024), default=2)
    parser.add_argument('--picture', type=Path, metavar='FILE', help='reliability diagrams, of all strategies together')
    parser.add_argument('--fit', action='store_true', help='choose the constants')
    given = parser.parse_args(arguments)
    try:
        if given.fit:
            fit(given.jobs)
            return 0
        last = [PAPER_CONDITIONS[given.condition].turns]
        cases = [(t, s, given.condition, n) for s in given.strategy for t in given.task for n in range(given.samples)]
        played = Parallel(given.jobs)(delayed(play)(*case, last) for case in cases)
        drawn: dict[str, list[Seen]] = {}
        for strategy in given.strategy:
            by_table: dict[str, list[Seen]] = {}
            for (_, of, _, _), (found,) in zip(cases, played, strict=True):
                for name, seen in found.items() if of == strategy else ():
                    by_table.setdefault(name, []).append(seen)
                    drawn.setdefault(name, []).append(seen)
            columns = ['', 'right', *NAMES, 'error', 'of none', 'q alone: right', *NAMES, 'threshold']
            rows = [[name, *scores(seen)] for name, seen in by_table.items()]
            print_table(f'{strategy}, {given.condition}, samples 0 to {given.samples - 1}', columns, rows)
        if given.picture is not None:
            print(draw(drawn, given.picture))
    except InputError as error:
        print(f'recognition: {error}', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
