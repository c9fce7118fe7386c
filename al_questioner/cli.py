"""The executables, by name, and the one place where an error becomes an exit status."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Sequence

from al_questioner import __version__
from al_questioner.domain import EpisodeError, InputError
from al_questioner.missing import remedy

EXECUTABLES = {
    'perception': ('al_questioner.ros.perception', 'node: looks at the (simulated) table and publishes what it sees'),
    'learner': ('al_questioner.ros.learner', 'node: decides what to ask, asks, and learns from the answers'),
    'teacher': (
        'al_questioner.ros.teacher',
        'node: answers the questions from a script; mode:=terminal lets you answer',
    ),
    'record': ('al_questioner.ros.record', 'node: records an episode into a bag; --repair makes a killed one whole'),
    'replay': (
        'al_questioner.ros.replay',
        'plays a bag on its topics; --check tells whether it leads to the same again',
    ),
    'session': ('al_questioner.session.command', "shows, checks, repairs and exports the log of a learner's session"),
    'train_weights': ('al_questioner.imitation.command', "learns the decision weights from an expert's bags"),
    'experiment': ('al_questioner.experiments.command', "plays, tests and draws the paper's comparison"),
    'demo': ('al_questioner.demo.command', 'plays one learning episode and shows how it went'),
}
"""Module and one-line description of each executable; the module is imported only when it is run."""


def usage() -> str:
    """What `--help` prints."""
    width = max(map(len, EXECUTABLES))
    lines = [f'  {name:<{width}}  {description}' for name, (_, description) in EXECUTABLES.items()]
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
    """Run one executable and return its exit status: 0, 2 for input that cannot be used, 1 for a failure."""
    arguments = list(sys.argv[1:] if arguments is None else arguments)
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
        status: int = importlib.import_module(EXECUTABLES[name][0]).main(rest)
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
        return 130
    return status
