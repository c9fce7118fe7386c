"""Work spread over processes of this machine, which leave interrupts to the one that started them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor
from multiprocessing import resource_tracker
from typing import Any, TypeVar

from joblib import Parallel, delayed

from al_questioner.domain import EpisodeError
from al_questioner.support import interrupts

Found = TypeVar('Found')


def do_in_processes(
    function: Callable[..., Found], work: Iterable[tuple[Any, ...]], jobs: int, advice: str
) -> Iterator[Found]:
    """Call a function with each of some tuples of arguments, and yield its results in any order.

    Args:
        function: can be pickled, as can its arguments and results; with one job they need not.
        work: arguments of each call.
        jobs: number of processes; 1 for this one.
        advice: what a person can do once a process has died.

    Raises:
        EpisodeError: a process died.
    """
    options = {'n_jobs': jobs, 'pre_dispatch': '2*n_jobs'}
    try:
        parallel = Parallel(return_as='generator_unordered', **options)
    except ValueError:
        # Before joblib 1.4 results come in the order of the work.
        parallel = Parallel(return_as='generator', **options)
    # The tracker unblocks interrupts when it starts, so start it before the workers, as joblib starts its own.
    resource_tracker.ensure_running()
    try:
        with parallel:
            with interrupts.blocked():
                results = parallel(delayed(function)(*piece) for piece in work)
            yield from results
    except BrokenExecutor as error:
        raise EpisodeError(f'a worker died (out of memory?); {advice}') from error
