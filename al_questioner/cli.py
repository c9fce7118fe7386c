"""The executables, by name, and the one place where an error becomes an exit status."""

from __future__ import annotations

import contextlib
import errno
import importlib
import io
import os
import signal
import sys
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

from al_questioner import __version__
from al_questioner.domain import EpisodeError, InputError
from al_questioner.support import interrupts
from al_questioner.support.missing_modules import remedy

NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Errors of a full disk, or of a file that may not grow: no fault of the program."""


class Executable(NamedTuple):
    """Parser and main function of a command, each as `MODULE:NAME`.

    They are in modules of their own so that a wrong option, or `--help`, does not wait for what the work needs.
    """

    parse: str
    run: str
    description: str


EXECUTABLES = {
    'perception': Executable(
        'al_questioner.ros.node_arguments:perception',
        'al_questioner.ros.nodes.perception:main',
        'node: looks at the (simulated) table and publishes what it sees',
    ),
    'learner': Executable(
        'al_questioner.ros.node_arguments:learner',
        'al_questioner.ros.nodes.learner:main',
        'node: decides what to ask, asks, and learns from the answers',
    ),
    'teacher': Executable(
        'al_questioner.ros.node_arguments:teacher',
        'al_questioner.ros.nodes.teacher:main',
        'node: answers the questions from a script; mode:=terminal lets you answer',
    ),
    'recognise': Executable(
        'al_questioner.ros.node_arguments:recogniser',
        'al_questioner.ros.nodes.recogniser:main',
        'node: tells what the things in view are taken for, and where the wanted one is',
    ),
    'record': Executable(
        'al_questioner.commands.record.arguments:parse',
        'al_questioner.commands.record.command:main',
        'node: records an episode into a bag; --repair makes a killed one whole',
    ),
    'replay': Executable(
        'al_questioner.commands.replay.arguments:parse',
        'al_questioner.commands.replay.command:main',
        'plays a bag on its topics; --check tells whether it leads to the same again',
    ),
    'session': Executable(
        'al_questioner.commands.session.arguments:parse',
        'al_questioner.commands.session.command:main',
        "shows, checks, repairs and exports the log of a learner's session",
    ),
    'concepts': Executable(
        'al_questioner.commands.concepts.arguments:parse',
        'al_questioner.commands.concepts.command:main',
        'shows, merges, changes and exports what learners know',
    ),
    'train_weights': Executable(
        'al_questioner.commands.train_weights.arguments:parse',
        'al_questioner.commands.train_weights.command:main',
        "learns the decision weights from an expert's bags",
    ),
    'experiment': Executable(
        'al_questioner.commands.experiment.arguments:parse',
        'al_questioner.commands.experiment.command:main',
        "plays, tests and draws comparisons of strategies: the paper's, or others",
    ),
    'demo': Executable(
        'al_questioner.commands.demo.arguments:parse',
        'al_questioner.commands.demo.command:main',
        'plays one learning episode and shows how it went',
    ),
}


def usage() -> str:
    """Return the text that `--help` prints."""
    width = max(map(len, EXECUTABLES))
    lines = [f'  {name:<{width}}  {description}' for name, (*_, description) in EXECUTABLES.items()]
    return '\n'.join(
        [
            'usage: python -m al_questioner EXECUTABLE [arguments]',
            '       ros2 run al_questioner EXECUTABLE [arguments]',
            '',
            *lines,
            '',
            'EXECUTABLE --help tells the arguments of one.',
        ]
    )


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one executable and return its exit status.

    0, 2 for input that cannot be used or a file that cannot be written, 1 for a failure, 130 if it was interrupted, 141
    if nobody reads what it prints.
    """
    arguments = list(sys.argv[1:] if arguments is None else arguments)
    name = arguments[0] if arguments and arguments[0] in EXECUTABLES else 'al_questioner'
    for stream in (sys.stdin, sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # What a terminal has no character for is no reason to lose all the rest.
            stream.reconfigure(errors='replace')
    try:
        try:
            return _run(arguments)
        finally:
            # Now, as Python would complain at length later.
            if sys.stdout is not None:
                sys.stdout.flush()
    except BrokenPipeError:
        _leave_output()
        return 128 + signal.SIGPIPE
    except SystemExit as end:
        # rich ends the process, with a status of its own.
        if isinstance(end.__context__, BrokenPipeError):
            return 128 + signal.SIGPIPE
        raise
    except OSError as error:
        if error.errno not in NO_ROOM:
            raise
        _leave_output()
        print(
            f'{name}: {error.filename or "the output, or a file,"} cannot be written ({error.strerror})',
            file=sys.stderr,
        )
        return 2


def _run(arguments: Sequence[str]) -> int:
    if not arguments or arguments[0] in ('-h', '--help'):
        print(usage())
        return 0 if arguments else 2
    if arguments[0] == '--version':
        print(f'al_questioner {__version__}')
        return 0
    name, *rest = arguments
    if name not in EXECUTABLES:
        print(f'al_questioner: unknown executable {name!r}; known: {", ".join(EXECUTABLES)}', file=sys.stderr)
        return 2
    try:
        given = _function(EXECUTABLES[name].parse)(rest)
        run = _function(EXECUTABLES[name].run)
        with interrupts.raised():
            status: int = run(given)
    except ModuleNotFoundError as error:
        if error.name is None or error.name.startswith('al_questioner'):
            raise
        print(f'{name}: {error}; {remedy(error.name)}', file=sys.stderr)
        return 2
    except InputError as error:
        print(f'{name}: {error}', file=sys.stderr)
        return 2
    except EpisodeError as error:
        print(f'{name}: {error}', file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return interrupts.STATUS
    return status


def _function(path: str) -> Callable[[Any], Any]:
    module, _, name = path.partition(':')
    function: Callable[[Any], Any] = getattr(importlib.import_module(module), name)
    return function


def _leave_output() -> None:
    """Let nobody complain about what could not be printed."""
    with contextlib.suppress(AttributeError, OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
