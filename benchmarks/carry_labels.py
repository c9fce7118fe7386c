"""Labels that follow things: what `carry_labels` is worth, and what it costs where tracks break or are confused.

    python benchmarks/carry_labels.py [--task TASK ...] [--budget B] [--turns T] [--samples N] [--out FILE]

Every strategy plays the same samples without and with `carry_labels`, in worlds whose tracks fail: at a change of a
thing's view it gets a new id with the probability `--breaks`, or exchanges its id with another thing whose view changes
then with the probability `--swaps`. Printed are, as means over the samples, the accuracy at the end, the number of
queries, and the difference that carrying makes with its standard error. Episodes that are in the file `--out` (CSV)
already are not played again.
"""

from __future__ import annotations

import argparse
import csv
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from measuring import print_table
from numpy.typing import NDArray

from al_questioner.domain import BUDGET, TURNS, InputError, Scene, random_stream
from al_questioner.experiments.plan import CONTROLS, PAPER_STRATEGIES, PROPOSED, Cell, Variation
from al_questioner.experiments.playing import play_in
from al_questioner.simulation import PerceivedWorld, Task, WorldSpec, load_task
from al_questioner.simulation.world import SeenWorld
from al_questioner.support.arguments import NumberWithin, add_option

STRATEGIES = (*PAPER_STRATEGIES, *PROPOSED, *CONTROLS)
TASKS = ('prepare_lunch', 'kitchen_table')
STAYING = ', things stay'
"""Behind the name of a task: its things stay on the table, and show new views at a change."""


class Tracks(NamedTuple):
    """Failures of the tracks: probabilities, at a change of a thing's view, of a new id and of another thing's."""

    breaks: float = 0.0
    swaps: float = 0.0

    def __str__(self) -> str:
        failures = [f'{share:.0%} {what}' for what, share in zip(self._fields, self, strict=True) if share]
        return ', '.join(failures) or 'whole'


class Played(NamedTuple):
    """One episode, and how it ended."""

    task: str
    budget: float
    turns: int
    breaks: float
    swaps: float
    strategy: str
    sample: int
    carries: int
    accuracy: float = float('nan')
    mean_accuracy: float = float('nan')
    queries: int = 0

    @property
    def key(self) -> Played:
        """The episode without its result."""
        return self._replace(accuracy=0.0, mean_accuracy=0.0, queries=0)


class FailingTracks:
    """A world in which perception loses things when their looks change.

    Args:
        world: with ids that follow the things.
        tracks: how often they fail.
        seed: of the failures.
    """

    def __init__(self, world: SeenWorld, tracks: Tracks, seed: int) -> None:
        self._world, self._tracks, self._seed = world, tracks, seed
        self._turns: list[tuple[Scene, Scene, Mapping[int, int]]] = []
        self._highest = 0

    def scene(self, turn: int) -> Scene:
        """Return the scene of a turn, with the ids that perception gives."""
        return self._turn(turn)[1]

    def truth(self, turn: int) -> Mapping[int, str]:
        """Return the symbols of a turn by these ids."""
        shown = self._turn(turn)[2]
        return {shown[thing]: symbol for thing, symbol in self._world.truth(turn).items()}

    def change_turns(self, turns: int) -> list[int]:
        """Return the turns up to `turns` that begin with a scene change."""
        return self._world.change_turns(turns)

    @property
    def test_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """The held-out observations of the world."""
        return self._world.test_set

    @property
    def validation_set(self) -> tuple[NDArray[np.float32], tuple[str, ...]]:
        """The second draw of held-out observations of the world."""
        return self._world.validation_set

    def report(self) -> str:
        """Return what the world says of its observations."""
        return self._world.report()

    def _turn(self, turn: int) -> tuple[Scene, Scene, Mapping[int, int]]:
        """Return the true scene of a turn, the one that is shown, and the shown ids by the true ones."""
        while len(self._turns) < turn:
            true = self._world.scene(len(self._turns) + 1)
            last = self._turns[-1] if self._turns else None
            self._turns.append(last if last is not None and last[0] is true else self._next(true, last))
        return self._turns[turn - 1]

    def _next(
        self, true: Scene, last: tuple[Scene, Scene, Mapping[int, int]] | None
    ) -> tuple[Scene, Scene, Mapping[int, int]]:
        self._highest = max(self._highest, *true.object_ids)
        before, _, shown = last or (true, true, {})
        ids = {thing: shown.get(thing, thing) for thing in true.object_ids}
        changed = [
            thing
            for thing, row in zip(true.object_ids, true.features, strict=True)
            if thing in before.object_ids and not np.array_equal(row, before.features[before.index_of(thing)])
        ]
        rng = random_stream(self._seed, f'tracks/{len(self._turns)}')
        for thing in changed:
            is_broken, is_swapped = rng.random(2) < (self._tracks.breaks, self._tracks.swaps)
            if is_broken:
                # Far above the ids of things that the world has still to bring.
                self._highest += 1
                ids[thing] = 1_000_000 + self._highest
            other = int(rng.choice(changed))
            if is_swapped:
                ids[thing], ids[other] = ids[other], ids[thing]
        return true, replace(true, object_ids=tuple(ids[thing] for thing in true.object_ids)), ids


def task_of(name: str) -> Task:
    """Return a task, perhaps with things that stay."""
    task = load_task(name.removesuffix(STAYING))
    if not name.endswith(STAYING):
        return task
    return replace(task, scenes=replace(task.scenes, turnover='state'))


def play(wanted: Sequence[Played], world: SeenWorld, world_spec: WorldSpec) -> Iterator[Played]:
    """Play episodes of one sample of a task."""
    for each in wanted:
        tracks = FailingTracks(world, Tracks(each.breaks, each.swaps), each.sample)
        cell = Cell(world_spec.task.name, each.budget, each.turns, each.strategy, each.sample)
        result = play_in(world_spec, tracks, cell, Variation(carry_labels=bool(each.carries)))
        mean = float(np.mean(result.accuracy))
        yield each._replace(accuracy=result.final_accuracy, mean_accuracy=mean, queries=len(result.queries))


def read_played(path: Path) -> dict[Played, Played]:
    """Return the episodes in a file, by their keys; none if there is no file."""
    if not path.is_file():
        return {}
    kinds = [type(default) for default in Played('', 0.0, 0, 0.0, 0.0, '', 0, 0)]
    with path.open(encoding='utf-8') as file:
        rows = [Played(*(kind(text) for kind, text in zip(kinds, row, strict=True))) for row in csv.reader(file)]
    return {row.key: row for row in rows}


def print_results(played: Sequence[Played], samples: int) -> None:
    """Print a table for each task and length: a row for each strategy, a column for each kind of track."""
    tables = dict.fromkeys((each.task, each.budget, each.turns) for each in played)
    for task, budget, turns in tables:
        of_table = [each for each in played if (each.task, each.budget, each.turns) == (task, budget, turns)]
        tracks = list(dict.fromkeys(Tracks(each.breaks, each.swaps) for each in of_table))
        rows = []
        for strategy in dict.fromkeys(each.strategy for each in of_table):
            rows.append([strategy])
            for failing in tracks:
                both = [
                    sorted(
                        (
                            each
                            for each in of_table
                            if (each.strategy, Tracks(each.breaks, each.swaps), each.carries)
                            == (strategy, failing, carries)
                        ),
                        key=lambda each: each.sample,
                    )
                    for carries in (0, 1)
                ]
                rows[-1] += _cells(*both)
        names = [text for failing in tracks for text in (f'{failing}: off', 'on', 'difference')]
        title = f'{task}, budget {budget:g}, time {turns}, samples 0 to {samples - 1}: accuracy (queries)'
        print_table(title, ['', *names], rows)


def _cells(without: Sequence[Played], carrying: Sequence[Played]) -> list[str]:
    accuracies = [np.array([each.accuracy for each in of_kind]) for of_kind in (without, carrying)]
    difference = accuracies[1] - accuracies[0]
    error = difference.std(ddof=1) / np.sqrt(len(difference)) if len(difference) > 1 else float('nan')
    texts = [
        f'{found.mean():.3f} ({np.mean([each.queries for each in of_kind]):.1f})'
        for found, of_kind in zip(accuracies, (without, carrying), strict=True)
    ]
    return [*texts, f'{difference.mean():+.3f} ± {error:.3f}']


def main(arguments: Sequence[str] | None = None) -> int:
    """Play what is not played yet, and print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    of_task = f'tasks; with "{STAYING}" behind the name its things stay, and show new views'
    parser.add_argument('--task', nargs='+', default=list(TASKS), help=of_task)
    parser.add_argument('--strategy', nargs='+', default=list(STRATEGIES), choices=STRATEGIES, metavar='NAME')
    add_option(parser, BUDGET)
    add_option(parser, TURNS)
    share = NumberWithin(float, 0, 1)
    parser.add_argument('--breaks', nargs='*', type=share, default=[0.0, 0.05, 0.2], help='(%(default)s)')
    parser.add_argument('--swaps', nargs='*', type=share, default=[0.05, 0.2], help='(%(default)s)')
    parser.add_argument('--samples', type=NumberWithin(int, 1, 100_000), default=20, help='from 0 on (%(default)s)')
    parser.add_argument('--out', type=Path, default=Path('out/carry_labels.csv'), help='(%(default)s)')
    given = parser.parse_args(arguments)
    all_tracks = [Tracks(breaks=each) for each in given.breaks] + [Tracks(swaps=each) for each in given.swaps]
    try:
        found = read_played(given.out)
        given.out.parent.mkdir(parents=True, exist_ok=True)
        wanted: list[Played] = []
        for task_name in given.task:
            task = task_of(task_name)
            for sample in range(given.samples):
                episodes = [
                    Played(task_name, given.budget, given.turns, *tracks, strategy, sample, carries, 0.0, 0.0)
                    for tracks in all_tracks
                    for strategy in given.strategy
                    for carries in (0, 1)
                ]
                wanted += episodes
                lacking = [each for each in episodes if each not in found]
                if not lacking:
                    continue
                world_spec = WorldSpec(task, sample, sample)
                with given.out.open('a', encoding='utf-8') as file:
                    for played in play(lacking, PerceivedWorld(world_spec.open()), world_spec):
                        csv.writer(file, lineterminator='\n').writerow(played)
                        file.flush()
                        found[played.key] = played
        print_results([found[each] for each in wanted], given.samples)
    except InputError as error:
        print(f'carry_labels: {error}', file=sys.stderr)
        return 2
    return 0


if __name__ == '__main__':
    sys.exit(main())
