"""Running an experiment: spread over processes or a cluster, resumed where it was interrupted."""

from __future__ import annotations

import csv
import itertools
import json
import os
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from joblib import Parallel, delayed, parallel_config

from al_questioner import __version__
from al_questioner.domain import InputError, SettingsError
from al_questioner.experiments.plan import Cell, Plan, Variation
from al_questioner.experiments.playing import EPISODE_COLUMNS, TURN_COLUMNS, Played, Row, play_cells
from al_questioner.files import make_folder, write_text

GROUPS_PER_JOB = 4
"""With fewer worlds for each process than that, the conditions of one are spread over several processes."""

Watcher = Callable[[int, int, Played | None], None]
"""Told at the start, and of each cell that was played, how many are there now, how many there will be, and what came of
it; None at the start."""


class Store:
    """The folder of an experiment: a manifest, a file for each finished cell, and the tables made from them.

    Args:
        folder: made if it is not there.
        plan: what is stored in it.
        dataset: root of a directory of crops.

    Raises:
        InputError: the folder cannot be written to, or holds an experiment that cannot be gone on with: of another
            version, or with other variations.
    """

    def __init__(self, folder: Path, plan: Plan, dataset: str = '') -> None:
        self.folder, self.plan, self.dataset = folder, plan, dataset
        self._cells = folder / 'cells'
        make_folder(self._cells)
        manifest = folder / 'manifest.json'
        determining = {'version': __version__, 'variation': plan.document()['variation'], 'dataset': dataset}
        if manifest.is_file():
            _check_same(manifest, determining)
        document = {**determining, **plan.document(), 'seeds': list(plan.samples), 'machine': _machine()}
        write_text(manifest, json.dumps(document, indent=1) + '\n')

    def load(self, cell: Cell) -> Played | None:
        """What was stored of a cell; None if nothing usable was."""
        try:
            document = json.loads(self._path(cell).read_text(encoding='utf-8'))
            return Played(cell, document['episode'], tuple(document['turns']))
        except (OSError, ValueError, KeyError, TypeError):
            return None

    def missing(self) -> list[tuple[Cell, ...]]:
        """The cells that nothing is stored of, together those that share a world."""
        groups = (tuple(cell for cell in group if self.load(cell) is None) for group in self.plan.groups())
        return [group for group in groups if group]

    def save(self, played: Played) -> None:
        """Store a cell; a crash meanwhile leaves no half of it."""
        path = self._path(played.cell)
        make_folder(path.parent)
        draft = path.with_suffix('.tmp')
        write_text(draft, json.dumps({'episode': played.episode, 'turns': played.turns}))
        draft.replace(path)

    def write_tables(self) -> list[Path]:
        """Write `episodes.csv` and `turns.csv` from what is stored of the plan, sorted."""
        stored = [played for cell in sorted(self.plan.cells()) if (played := self.load(cell)) is not None]
        episodes, turns = self.folder / 'episodes.csv', self.folder / 'turns.csv'
        _write_csv(episodes, EPISODE_COLUMNS, (played.episode for played in stored))
        _write_csv(turns, TURN_COLUMNS, (row for played in stored for row in played.turns))
        return [episodes, turns]

    def _path(self, cell: Cell) -> Path:
        return self._cells / cell.task / f'{cell.condition}'.replace('/', '-') / cell.strategy / f'{cell.sample}.json'


def run(
    stores: Sequence[Store],
    jobs: int = 1,
    scheduler: str | None = None,
    watch: Watcher | None = None,
) -> list[Played]:
    """Play all cells of some experiments that are not stored yet, and return those that failed.

    Args:
        stores: of the experiments.
        jobs: number of local processes; 1 for this one.
        scheduler: address of a dask scheduler that spreads the work instead.
        watch: told of the start and of each cell that was played.

    Raises:
        InputError: dask is not installed, or there is no scheduler at the address.
    """
    missing = [(number, group) for number, store in enumerate(stores) for group in store.missing()]
    if scheduler or len(missing) < GROUPS_PER_JOB * jobs:
        missing = [(number, part) for number, group in missing for part in _by_condition(group)]
    total = sum(len(store.plan.cells()) for store in stores)
    done = total - sum(len(group) for _, group in missing)
    if watch is not None:
        watch(done, total, None)
    failed = []
    with _backend(scheduler):
        parallel = Parallel(n_jobs=-1 if scheduler else jobs, return_as='generator_unordered', pre_dispatch='2*n_jobs')
        tasks = (
            delayed(_play_numbered)(number, group, stores[number].plan.variation, stores[number].dataset)
            for number, group in missing
        )
        for number, results in parallel(tasks):
            for played in results:
                done += 1
                if played.error:
                    failed.append(played)
                else:
                    stores[number].save(played)
                if watch is not None:
                    watch(done, total, played)
    return failed


def _by_condition(cells: Sequence[Cell]) -> list[tuple[Cell, ...]]:
    """The cells of each condition: more, but smaller pieces of work, each of which opens the world anew."""
    return [tuple(part) for _, part in itertools.groupby(cells, lambda cell: cell.condition)]


def _play_numbered(number: int, cells: Sequence[Cell], variation: Variation, dataset: str) -> tuple[int, list[Played]]:
    """`play_cells`, with the number of the experiment that the results belong to, as they come in any order."""
    return number, play_cells(cells, variation, dataset)


@contextmanager
def _backend(scheduler: str | None) -> Iterator[None]:
    """Joblib's own processes, or the workers of a dask cluster."""
    if scheduler is None:
        yield
        return
    try:
        from dask.distributed import Client
    except ImportError as error:
        raise InputError('dask is not installed: pip install ".[cluster]"') from error
    try:
        client = Client(scheduler, timeout='10s')  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise InputError(f'no dask scheduler answers at {scheduler} ({" ".join(str(error).split())})') from error
    with client, parallel_config(backend='dask', wait_for_workers_timeout=30):
        yield


def _check_same(manifest: Path, determining: dict[str, Any]) -> None:
    try:
        before = json.loads(manifest.read_text(encoding='utf-8'))
    except (OSError, ValueError) as error:
        raise InputError(f'{manifest} cannot be read ({error})') from error
    for name, value in determining.items():
        if before.get(name) != json.loads(json.dumps(value)):
            raise SettingsError(
                f'{manifest.parent} holds an experiment with {name} {before.get(name)}, this one has {value}:'
                ' choose another folder'
            )


def _machine() -> dict[str, Any]:
    """Where and when it was run, for people."""
    return {
        'python': platform.python_version(),
        'platform': platform.platform(),
        'processor': platform.machine(),
        'cores': os.cpu_count(),
        'begun': time.strftime('%Y-%m-%dT%H:%M:%S%z'),
    }


def _write_csv(path: Path, columns: Sequence[str], rows: Iterator[Row]) -> None:
    draft = path.with_suffix('.tmp')
    try:
        with draft.open('w', newline='', encoding='utf-8') as file:
            writer = csv.DictWriter(file, columns)
            writer.writeheader()
            writer.writerows(rows)
        draft.replace(path)
    except OSError as error:
        raise InputError(f'{path} cannot be written ({error.strerror})') from error
