"""The `replay` executable: plays a bag on its topics, shows its scenes to a learner, or checks it."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from rich.console import Console
from rich.live import Live
from rich.text import Text

from al_questioner.bags import LeftOut, read_bag, read_episodes
from al_questioner.bags.playback import STEP, Playback, without_steps_back
from al_questioner.bags.scenes import scenes_of
from al_questioner.commands.replay.arguments import KEYS
from al_questioner.domain import EpisodeError
from al_questioner.event_log.replay import first_divergence
from al_questioner.messages.stamps import SECOND
from al_questioner.ros.message_classes import installed_part
from al_questioner.support.text import number_of

if TYPE_CHECKING:
    from al_questioner.ros.nodes.recorded_perception import RecordedPerceptionNode
    from al_questioner.ros.nodes.replayer import ReplayNode

Shown = TypeVar('Shown', 'ReplayNode', 'RecordedPerceptionNode')


def main(given: argparse.Namespace) -> int:
    """Play a bag, show its scenes to a learner, or check it."""
    console, ros = Console(), given.ros
    if given.check:
        return _check(given.bag, console)
    if given.as_perception:
        return _serve_scenes(given.bag, ros, console)
    bag, missing = installed_part(read_bag(given.bag))
    messages = without_steps_back(bag.messages)
    playback = Playback(messages, given.rate, given.loop, given.start_paused)
    for type_, topics in missing.items():
        _warn(console, f'{", ".join(topics)}: passed over, as the message type {type_} is not installed')
    put_back = messages[-1].stamp - bag.messages[-1].stamp
    if put_back > STEP:
        by = f'{put_back / SECOND:.1f} s'
        _warn(console, f"the recorder's clock was put back by {by} meanwhile: played in the order of the recording")
    console.print(
        f'{given.bag}: {len(bag.messages)} messages, {playback.duration:.1f} s', highlight=False, soft_wrap=True
    )
    from al_questioner.ros.nodes.replayer import ReplayNode

    node = _run(
        lambda: ReplayNode(bag, playback, given.wait_for_subscribers, given.clock), ros, console, _status_of_playback
    )
    played = f'{playback.position} of {len(bag.messages)} messages played, {playback.turn} of {playback.turns} turns'
    console.print(played if node is not None and node.started else 'nothing was played', highlight=False)
    return 0


def _warn(console: Console, text: str) -> None:
    console.print(f'WARNING: {text}', style='yellow', markup=False, highlight=False, soft_wrap=True)


def _serve_scenes(path: Path, ros: Sequence[str], console: Console) -> int:
    scenes = scenes_of(read_bag(path))
    last = max(scenes.clouds)
    console.print(f'{path}: scenes of {len(scenes.clouds)} turns, the last is turn {last}', highlight=False)
    from al_questioner.ros.nodes.recorded_perception import RecordedPerceptionNode

    node = _run(
        lambda: RecordedPerceptionNode(scenes),
        ros,
        console,
        lambda node, keys: f'turn {node.turn} of {last}' + ('\nq: quit' if keys else ''),
    )
    console.print(f'the last scene that was asked for: turn {node.turn if node else 0}', highlight=False)
    return 0


def _run(
    make: Callable[[], Shown], ros: Sequence[str], console: Console, status: Callable[[Shown, bool], str]
) -> Shown | None:
    """Spin a node until it is over, with its status at the bottom of a terminal; None if it was never made.

    The status is told whether keys are read.

    Raises:
        InputError: the node must not go on.
    """
    from al_questioner.ros.keyboard import Keys
    from al_questioner.ros.running import Spinner

    node: Shown | None = None
    with Live(console=console, auto_refresh=False, transient=True) as live, Spinner(ros) as spinner:
        node = spinner.add(make)
        with Keys(node.press) as keys:

            def show() -> bool:
                if console.is_terminal:
                    live.update(Text(status(node, keys.active)), refresh=True)
                return node.over

            spinner.spin(show)
    if node is not None and node.failure is not None:
        raise node.failure
    return node


def _status_of_playback(node: ReplayNode, keys: bool) -> str:
    play = node.playback
    waiting = '' if node.started else ' · waiting for listeners'
    state = f'rate {play.rate:.3g}' + (' · paused' if play.paused else waiting)
    position = f'{play.elapsed(time.monotonic()):.1f} of {play.duration:.1f} s · turn {play.turn} of {play.turns}'
    return f'{position} · {state}' + (f'\n{KEYS}' if keys else '')


def _check(path: Path, console: Console) -> int:
    """Compare every episode of a bag with a new run on what was recorded.

    Raises:
        EpisodeError: a decision differs, or something could not be checked; the text names the first difference.
    """
    left_out: list[LeftOut] = []
    for episode in read_episodes(path, left_out):
        where = f'{path}: {episode.started.episode_id}'
        divergence = first_divergence(episode.started, episode.events)
        if divergence is not None:
            raise EpisodeError(f'{where}: {divergence}')
        played, of = episode.decisions, episode.started.settings.turns
        checked = number_of(played, 'decision') if played == of else f'{played} of {number_of(of, "turn")}'
        console.print(f'{where}: {checked}, all as recorded', highlight=False, soft_wrap=True)
    for what, reason in left_out:
        console.print(f'{path}: {what}: cannot be checked: {reason}', highlight=False, markup=False, soft_wrap=True)
    if left_out:
        raise EpisodeError(f'{path}: not all of it was checked')
    return 0
