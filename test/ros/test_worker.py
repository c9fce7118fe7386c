"""The thread behind every node: its jobs run in order, and none of them ends it."""

from __future__ import annotations

import threading

import pytest

from al_questioner.ros.worker import Worker


def test_a_failing_job_is_told_and_the_next_one_runs() -> None:
    """Otherwise one unexpected error would leave a node that hears and never answers."""
    errors: list[Exception] = []
    done: list[int] = []
    worker = Worker('test', errors.append)

    def fail() -> None:
        raise KeyError('unexpected')

    worker.submit(lambda: done.append(1))
    worker.submit(fail)
    worker.submit(lambda: done.append(2))
    worker.finish()
    assert done == [1, 2]
    assert [str(error) for error in errors] == ["'unexpected'"]


@pytest.mark.parametrize(('most', 'kept'), [(1, [0, 9]), (3, [0, 7, 8, 9])])
def test_of_what_waits_for_a_busy_worker_the_newest_is_kept(most: int, kept: list[int]) -> None:
    """Otherwise the memory beside a fast camera would fill with clouds that are old when they are looked at."""
    handled: list[int] = []
    begun, may_go_on = threading.Event(), threading.Event()
    worker = Worker('test', lambda error: None)

    def handle(message: int) -> None:
        begun.set()
        may_go_on.wait(30)
        handled.append(message)

    put = worker.inbox(handle, most)
    put(0)
    assert begun.wait(30)
    for message in range(1, 10):
        put(message)
    may_go_on.set()
    worker.finish()
    assert handled == kept


def test_jobs_are_done_in_the_order_in_which_they_are_due() -> None:
    """Otherwise a turn would begin before its time, or what waits for a late job would wait, too."""
    done: list[str] = []
    finished = threading.Event()
    worker = Worker('test', lambda error: None)
    worker.submit(finished.set, 0.2)
    worker.submit(lambda: done.append('second'), 0.1)
    cancel = worker.submit(lambda: done.append('called off'), 0.05)
    worker.submit(lambda: done.append('first'))
    cancel()
    assert finished.wait(30)
    cancel()
    worker.stop()
    assert done == ['first', 'second']


def test_what_is_due_is_done_before_the_end() -> None:
    """Otherwise a bag would lack the last messages that were heard."""
    done: list[int] = []
    begun, may_go_on = threading.Event(), threading.Event()
    worker = Worker('test', lambda error: None)
    worker.submit(lambda: (begun.set(), may_go_on.wait(30)))
    assert begun.wait(30)
    worker.submit(lambda: done.append(1))
    worker.submit(lambda: done.append(2), 3600.0)
    may_go_on.set()
    worker.finish()
    assert done == [1]
    assert worker.stopped


def test_nothing_is_done_after_the_stop() -> None:
    """Otherwise a node that is being destroyed would publish on topics that are gone."""
    done: list[int] = []
    worker = Worker('test', lambda error: None)
    worker.stop()
    worker.submit(lambda: done.append(1))
    assert not done
