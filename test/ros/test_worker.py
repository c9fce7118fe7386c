"""The thread behind every node: its jobs run in order, and none of them ends it."""

from __future__ import annotations

import threading

from al_questioner.ros.worker import Worker


def test_a_failing_job_is_told_and_the_next_one_runs() -> None:
    """One unexpected error would leave a node that hears and never answers."""
    errors: list[Exception] = []
    done: list[int] = []
    finished = threading.Event()
    worker = Worker('test', errors.append)

    def fail() -> None:
        raise KeyError('unexpected')

    worker.submit(lambda: done.append(1))
    worker.submit(fail)
    worker.submit(lambda: done.append(2))
    worker.submit(finished.set)
    assert finished.wait(30)
    worker.stop()
    assert done == [1, 2]
    assert [str(error) for error in errors] == ["'unexpected'"]


def test_nothing_is_done_after_the_stop() -> None:
    """A node that is being destroyed would publish on topics that are gone."""
    done: list[int] = []
    worker = Worker('test', lambda error: None)
    worker.stop()
    worker.submit(lambda: done.append(1))
    assert not done
