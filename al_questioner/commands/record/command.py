"""Records the topics of learning episodes into a bag, or makes one whole whose recording was killed (--repair)."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from al_questioner.bags import repair
from al_questioner.domain import EpisodeError
from al_questioner.support.text import number_of

if TYPE_CHECKING:
    from al_questioner.ros.nodes.recorder import RecorderNode


def main(given: argparse.Namespace) -> int:
    """Record until the process is told to end, or repair a bag, for which ROS is not needed."""
    if given.repair is not None:
        return _repair(given.repair)
    from al_questioner.ros.nodes.recorder import RecorderNode
    from al_questioner.ros.running import Spinner

    node: RecorderNode | None = None
    with Spinner(given.ros) as spinner:
        node = spinner.add(RecorderNode)
        spinner.spin(lambda: node.machine.done or node.machine.failure is not None)
    if node is None:
        return 0
    machine = node.machine
    if machine.failure is not None:
        raise machine.failure
    total = number_of(machine.written, 'message')
    Console().print(f'{machine.path}: {total}, the bag is whole', highlight=False, markup=False, soft_wrap=True)
    if machine.until_done and not machine.done:
        raise EpisodeError('ended before the episode was over; the bag is whole as far as it goes')
    return 0


def _repair(path: Path) -> int:
    report = repair(path)
    console = Console()
    total = sum(report.kept.values())
    if report.was_whole:
        console.print(f'{path} is whole: {total} messages', highlight=False, soft_wrap=True)
        return 0
    broken = 'broken file is' if len(report.originals) == 1 else 'broken files are'
    names = ', '.join(map(str, report.originals))
    console.print(f'{path}: {total} messages kept, the {broken} now {names}', soft_wrap=True)
    for topic, count in sorted(report.kept.items()):
        console.print(f'  {count:>6}  {topic}', highlight=False, soft_wrap=True)
    return 0
