"""Records the topics of learning episodes into a bag, or makes one whole whose recording was killed (--repair)."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from al_questioner.domain import EpisodeError, InputError
from al_questioner.recording import repair

if TYPE_CHECKING:
    from al_questioner.ros.recorder import RecorderNode


def main(arguments: Sequence[str]) -> int:
    """Record until the process is told to end, or repair a bag, for which ROS is not needed."""
    if arguments and arguments[0] == '--repair':
        if len(arguments) != 2:
            raise InputError(f'--repair takes one bag, not {len(arguments) - 1}')
        return _repair(Path(arguments[1]))
    from al_questioner.ros.parameters import help_text
    from al_questioner.ros.recorder import RecorderNode
    from al_questioner.ros.running import run_nodes
    from al_questioner.ros.settings import RECORDER_SETTINGS

    made: list[RecorderNode] = []

    def make() -> RecorderNode:
        made.append(RecorderNode())
        return made[0]

    description = f'{__doc__}\n\nusage: record --ros-args -p bag:=PATH ...\n       record --repair BAG'
    run_nodes(
        [make],
        arguments,
        help_text(description, RECORDER_SETTINGS),
        lambda: made[0].done or made[0].failure is not None,
    )
    if made and made[0].failure is not None:
        raise made[0].failure
    if made and made[0].until_done and not made[0].done:
        raise EpisodeError('ended before the episode was over; the bag is whole as far as it goes')
    return 0


def _repair(path: Path) -> int:
    report = repair(path)
    console = Console()
    total = sum(report.kept.values())
    if report.was_whole:
        console.print(f'{path} is whole: {total} messages', highlight=False, soft_wrap=True)
        return 0
    console.print(f'{path}: {total} messages kept, the broken file is now {report.original}', soft_wrap=True)
    for topic, count in sorted(report.kept.items()):
        console.print(f'  {count:>6}  {topic}', highlight=False, soft_wrap=True)
    return 0
