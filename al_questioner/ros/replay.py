"""The `replay` executable: plays a bag on its topics, or checks that it leads to the same decisions again."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.live import Live
from rich.text import Text

from al_questioner.arguments import Parser, number
from al_questioner.domain import EpisodeError
from al_questioner.recording import read_bag, read_sessions
from al_questioner.recording.playback import Playback
from al_questioner.rerun import first_divergence

if TYPE_CHECKING:
    from al_questioner.ros.replayer import ReplayNode

KEYS = 'space: pause · right or n: a turn · s: a message · up, down: rate · q: quit'


def parser() -> Parser:
    """The arguments of `replay`; ROS arguments may follow."""
    result = Parser(prog='replay', description='Play a bag on the topics it was recorded from, with its timing.')
    result.add_argument('bag', type=Path, metavar='BAG', help='directory of the bag')
    result.add_argument('--rate', type=float, default=1.0, help='recorded seconds in a second (%(default)s)')
    result.add_argument('--loop', action='store_true', help='begin anew at the end')
    clock_help = 'publish the recorded time on /clock so often (0: not at all)'
    result.add_argument('--clock', type=number(float, 0, 1000), default=0.0, metavar='HZ', help=clock_help)
    result.add_argument('--paused', action='store_true', help='begin with a pause')
    delay_help = 'seconds before the first message, for listeners to appear (%(default)s)'
    result.add_argument('--delay', type=number(float, 0, 3600), default=1.0, help=delay_help)
    check_help = 'do not play: tell whether the recorded scenes and answers give the recorded decisions; needs no ROS'
    result.add_argument('--check', action='store_true', help=check_help)
    return result


def main(arguments: Sequence[str]) -> int:
    """Play a bag, or check it."""
    own, ros = _split(arguments)
    given = parser().parse_args(own)
    console = Console()
    if given.check:
        return _check(given.bag, console)
    bag = read_bag(given.bag)
    playback = Playback(bag.messages, given.rate, given.loop, given.paused)
    from al_questioner.ros.keys import Keys
    from al_questioner.ros.replayer import ReplayNode
    from al_questioner.ros.running import run_nodes

    made: list[ReplayNode] = []

    def make() -> ReplayNode:
        made.append(ReplayNode(bag, playback, given.delay, given.clock))
        return made[0]

    console.print(f'{given.bag}: {len(bag.messages)} messages, {playback.duration:.1f} s', highlight=False)
    with Live(console=console, auto_refresh=False, transient=True) as live:

        def watch() -> bool:
            if console.is_terminal:
                live.update(Text(_status(made[0])), refresh=True)
            return made[0].quit or playback.done

        with Keys(lambda key: made[0].press(key) if made else None):
            run_nodes([make], ros, '', watch)
    console.print(f'{playback.position} of {len(bag.messages)} messages played', highlight=False)
    return 0


def _split(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """One's own arguments, and those of ROS."""
    at = arguments.index('--ros-args') if '--ros-args' in arguments else len(arguments)
    return list(arguments[:at]), list(arguments[at:])


def _status(node: ReplayNode) -> str:
    playback = node.playback
    state = 'paused' if playback.paused else f'rate {playback.rate:g}'
    return f'turn {node.turn} · {playback.elapsed(time.monotonic()):.1f} of {playback.duration:.1f} s · {state}\n{KEYS}'


def _check(path: Path, console: Console) -> int:
    """Compare every episode of a bag with a new run on what was recorded.

    Raises:
        EpisodeError: a decision differs; the text names the first.
    """
    for session in read_sessions(path):
        divergence = first_divergence(session)
        if divergence is not None:
            raise EpisodeError(f'{path}: {session.episode_id}: turn {divergence.turn}: {divergence.what}')
        console.print(
            f'{path}: {session.episode_id}: {len(session.turns)} decisions, all as recorded',
            highlight=False,
            soft_wrap=True,
        )
    return 0
