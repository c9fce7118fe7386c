"""Work spread over processes."""

import os
import signal

import pytest

from al_questioner.domain import EpisodeError
from al_questioner.experiments.processes import do_in_processes


def test_interrupts_are_left_to_the_process_that_was_started() -> None:
    """Otherwise each process that plays would print where Ctrl-C met it, also while it starts."""

    def are_blocked() -> bool:
        return signal.SIGINT in signal.pthread_sigmask(signal.SIG_BLOCK, [])

    assert list(do_in_processes(are_blocked, [()] * 4, 2, '')) == [True] * 4
    assert not are_blocked()


def test_a_process_that_dies_is_told() -> None:
    """Otherwise people see the traceback of a library that they do not know."""

    def die() -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    with pytest.raises(EpisodeError, match='a worker died'):
        list(do_in_processes(die, [()] * 2, 2, 'try fewer jobs'))
