"""Running of experiments: in several processes or on a cluster, resumed after an interruption."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Callable, Iterator, Sequence

from al_questioner.domain import EpisodeError, InputError
from al_questioner.experiments.plan import Cell
from al_questioner.experiments.playing import Played, play_cells
from al_questioner.experiments.processes import do_in_processes
from al_questioner.experiments.storing import Store

GROUPS_PER_JOB = 4
"""Number of worlds per process below which the conditions of one world are spread over several processes."""

AGAIN = 'finished episodes are kept, start it again'
WAIT_SECONDS = 30
"""Seconds to wait for the first worker of a cluster."""

Work = tuple[int, Store, Sequence[Cell], bool]
"""Arguments of `_play`."""
Results = Iterator[tuple[int, list[Played]]]


def run(
    stores: Sequence[Store],
    jobs: int = 1,
    scheduler: str | None = None,
    begin: Callable[[Sequence[Cell]], None] | None = None,
    watch: Callable[[Played], None] | None = None,
) -> list[Played]:
    """Play all cells of some experiments that are not stored yet, and return those that failed.

    Args:
        stores: stores of the experiments.
        jobs: number of local processes; 1 for this one.
        scheduler: address of a dask scheduler that distributes the work instead.
        begin: called with the cells that will be played.
        watch: called with each cell that was played.

    Raises:
        EpisodeError: a worker process died.
        InputError: dask is not installed, or there is no scheduler at the address.
    """
    missing = [(number, group) for number, store in enumerate(stores) for group in store.missing()]
    # One after the other what is played in the same world, since a process keeps the last worlds that it has opened.
    missing.sort(key=lambda piece: _world_of(stores[piece[0]], piece[1][0]))
    if scheduler or len(missing) < GROUPS_PER_JOB * jobs:
        missing = [(number, part) for number, group in missing for part in _by_condition(group)]
    if begin is not None:
        begin([cell for _, group in missing for cell in group])
    work = [(number, stores[number], group, scheduler is None) for number, group in missing]
    failed = []
    done = do_in_processes(_play, work, jobs, AGAIN) if scheduler is None else _on_cluster(work, scheduler)
    for number, results in done:
        for played in results:
            if played.error:
                failed.append(played)
            elif scheduler is not None:
                stores[number].save(played)
            if watch is not None:
                watch(played)
    return failed


def _world_of(store: Store, cell: Cell) -> tuple[int, str, str]:
    """Return what distinguishes the world of a cell from others; samples come in their order."""
    variation = store.plan.variation
    return cell.sample, cell.task, f'{variation.change_interval} {variation.synchrony}'


def _by_condition(cells: Sequence[Cell]) -> list[tuple[Cell, ...]]:
    """Return the cells of each condition: more, but smaller pieces of work, each of which opens the world again."""
    return [tuple(part) for _, part in itertools.groupby(cells, lambda cell: cell.condition)]


def _play(number: int, store: Store, cells: Sequence[Cell], keep: bool) -> tuple[int, list[Played]]:
    """Play the cells of an experiment, and store each at once if the folder is on this machine.

    Returns:
        The number of the experiment, since results come in any order, and the played cells.
    """
    found = []
    for played in play_cells(cells, store.plan.variation, store.dataset):
        if keep and not played.error:
            store.save(played)
        found.append(played)
    return number, found


def _on_cluster(work: Sequence[Work], scheduler: str) -> Results:
    """Play on the workers of a dask cluster.

    Raises:
        EpisodeError: no worker came, or workers died repeatedly at the same episodes.
        InputError: dask is not installed, or there is no scheduler at the address.
    """
    try:
        from dask.distributed import Client, KilledWorker, as_completed
    except ImportError as error:
        raise InputError('dask is not installed: pip install ".[cluster]"') from error
    try:
        client = Client(scheduler, timeout='10s')  # type: ignore[no-untyped-call]
    except (OSError, ValueError) as error:
        raise InputError(f'no dask scheduler answers at {scheduler} ({" ".join(str(error).split())})') from error
    with client:
        try:
            client.wait_for_workers(1, timeout=WAIT_SECONDS)
        except asyncio.TimeoutError as error:
            raise EpisodeError(f'{scheduler}: no worker came within {WAIT_SECONDS} s') from error
        try:
            futures = [client.submit(_play, *piece, pure=False) for piece in work]
            for future in as_completed(futures):  # type: ignore[no-untyped-call]
                yield future.result()
        except KilledWorker as error:
            raise EpisodeError(f'workers of the cluster died; {AGAIN}') from error
