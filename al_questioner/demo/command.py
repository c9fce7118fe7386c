"""The `demo` executable."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from rich.console import Console

from al_questioner.demo.pictures import draw_pictures
from al_questioner.demo.progress import Progress
from al_questioner.demo.report import episode_document, summary
from al_questioner.domain import EpisodeSettings, InputError, QueryRecord
from al_questioner.questioning import STRATEGIES
from al_questioner.simulation import (
    EpisodeResult,
    Evaluation,
    TurnWatcher,
    WorldChoice,
    episode_settings,
    run_episode,
)
from al_questioner.teaching import ScriptedTeacher
from al_questioner.world import load_task


class Parser(argparse.ArgumentParser):
    """A parser whose complaints are one line, as those of every executable here."""

    def error(self, message: str) -> NoReturn:
        """Raise an InputError instead of printing the usage."""
        raise InputError(f'{message} (--help tells the arguments)')


def parser() -> Parser:
    """The arguments of `demo`."""
    result = Parser(prog='demo', description='Play one learning episode, show how it goes, and draw how it went.')
    result.add_argument('--task', default='kitchen_table', help='a name in config/tasks, or a YAML file (%(default)s)')
    result.add_argument('--dataset', type=Path, help='root of a directory of RGB-D crops, for tasks that read one')
    result.add_argument('--strategy', help=f"one of {', '.join(STRATEGIES)} (the task's)")
    result.add_argument('--weights-file', help='YAML file with weights of the decision features')
    result.add_argument('--budget', type=float, help="query budget (the task's)")
    result.add_argument('--turns', type=int, help="length of the episode (the task's)")
    result.add_argument('--seed', type=int, default=0, help='seed of everything drawn at random (%(default)s)')
    result.add_argument('--sample', type=int, help='sample of observations to draw the scenes from (that of the seed)')
    result.add_argument('--wrong-rate', type=float, default=0.0, help='share of wrong answers (%(default)s)')
    result.add_argument('--unknown-rate', type=float, default=0.0, help='share of "I do not know" (%(default)s)')
    result.add_argument('--turn-period', type=float, default=0.0, help='least seconds from turn to turn (%(default)s)')
    result.add_argument('--out', type=Path, default=Path('out/demo'), help='folder for the pictures (%(default)s)')
    result.add_argument('--json', type=Path, metavar='FILE', help='write the episode as JSON')
    result.add_argument('--namespace', help='of the ROS topics (one of its own for each run)')
    where = result.add_mutually_exclusive_group()
    where.add_argument('--offline', action='store_true', help='the same episode without ROS')
    where.add_argument('--one-process', action='store_true', help='the ROS nodes in this process, not one process each')
    return result


def main(arguments: Sequence[str]) -> int:
    """Run the demo."""
    given = parser().parse_args(arguments)
    seed = given.seed
    choice = WorldChoice(load_task(given.task), seed, seed if given.sample is None else given.sample, given.dataset)
    settings = episode_settings(choice.task, given.strategy, given.budget, given.turns, weights_file=given.weights_file)
    teacher = ScriptedTeacher(
        choice.task.symbols, choice.task.relevant_groups, seed, given.wrong_rate, given.unknown_rate
    )
    console = Console()
    with Progress(console, choice.task, settings) as progress:
        if given.offline:
            result = run_episode(choice, settings, teacher, progress.after_turn)
        else:
            result = _run_graph(given, choice, settings, progress.after_turn)
    world = Evaluation(choice, settings).world
    pictures = draw_pictures(result, world, given.out)
    if given.json is not None:
        _write(given.json, json.dumps(episode_document(result), indent=1) + '\n')
    console.print(summary(result))
    if notes := world.world.report():
        console.print(notes, highlight=False, markup=False)
    for path in (*pictures, *([given.json] if given.json else [])):
        console.print(f'  {path}', highlight=False)
    return 0


def _run_graph(
    given: argparse.Namespace, choice: WorldChoice, settings: EpisodeSettings, watch: TurnWatcher
) -> EpisodeResult:
    """Have the ROS nodes play the episode, and measure what they report.

    Raises:
        InputError: ROS is not installed.
    """
    try:
        from al_questioner.ros.graph import Graph
    except ImportError as error:
        raise InputError(
            f'ROS 2 cannot be imported ({error}): install it (pip install "al_questioner[ros]"), or use --offline'
        ) from error
    world = {'task': given.task, 'dataset': str(given.dataset or ''), 'seed': choice.seed, 'sample': choice.sample}
    evaluation = Evaluation(choice, settings)

    def follow(turn: int, queries: tuple[QueryRecord, ...]) -> None:
        by_turn = {record.turn: record for record in queries}
        while evaluation.turn < turn:
            record = by_turn.get(evaluation.turn + 1)
            accuracy = evaluation.next_turn(record)
            watch(evaluation.turn, record, accuracy)

    Graph(
        namespace=given.namespace or f'demo_{os.getpid()}',
        parameters={
            'perception': world,
            'teacher': {**world, 'wrong_rate': given.wrong_rate, 'unknown_rate': given.unknown_rate},
            'learner': {
                **world,
                'strategy': settings.strategy,
                'budget': settings.budget,
                'turns': settings.turns,
                'weights_file': given.weights_file or '',
                'turn_period': given.turn_period,
            },
        },
        one_process=given.one_process,
        log_dir=given.out / 'logs',
    ).play(follow)
    return evaluation.result()


def _write(path: Path, text: str) -> None:
    """Write a file and the folders it lies in.

    Raises:
        InputError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding='utf-8')
    except OSError as error:
        raise InputError(f'{path} cannot be written ({error.strerror})') from error
