"""The `demo` executable."""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from al_questioner.arguments import LARGEST_SEED, Parser, number
from al_questioner.concepts import compile_models
from al_questioner.configuration import shipped_names
from al_questioner.demo.pictures import draw_pictures
from al_questioner.demo.progress import Progress
from al_questioner.demo.report import episode_document, summary
from al_questioner.domain import InputError, QueryRecord
from al_questioner.files import check_writable, make_folder, write_text
from al_questioner.messages.schemas import LARGEST_TURN
from al_questioner.questioning import STRATEGIES
from al_questioner.simulation import (
    Evaluation,
    TurnWatcher,
    WorldChoice,
    episode_settings,
    play,
)
from al_questioner.teaching import ScriptedTeacher
from al_questioner.world import load_task

PATIENCE = 30.0
"""Seconds without progress after which the warning of a node ends the demo."""


def parser() -> Parser:
    """The arguments of `demo`."""
    result = Parser(prog='demo', description='Play one learning episode, show how it goes, and draw how it went.')
    tasks = ', '.join(shipped_names('tasks'))
    task_help = f'{tasks}, or a YAML file (%(default)s)'
    result.add_argument('--task', default='kitchen_table', help=task_help)
    result.add_argument('--dataset', type=Path, help='root of a directory of RGB-D crops, for tasks that read one')
    result.add_argument('--strategy', help=f"one of {', '.join(STRATEGIES)}, or of an installed package (the task's)")
    result.add_argument('--weights-file', help='YAML file with weights of the decision features')
    result.add_argument('--budget', type=float, help="query budget (the task's)")
    turns = number(int, 1, LARGEST_TURN)
    result.add_argument('--turns', type=turns, help="length of the episode (the task's)")
    tune_every = number(int, 0, LARGEST_TURN)
    tune_help = "turns from one re-optimisation of the models' kernel to the next, 0 for never (%(default)s)"
    result.add_argument('--tune-every', type=tune_every, default=0, metavar='K', help=tune_help)
    seed = number(int, 0, LARGEST_SEED)
    result.add_argument('--seed', type=seed, default=0, help='seed of everything drawn at random (%(default)s)')
    result.add_argument('--sample', type=seed, help='sample of observations to draw the scenes from (that of the seed)')
    result.add_argument('--wrong-rate', type=float, default=0.0, help='share of wrong answers (%(default)s)')
    result.add_argument('--unknown-rate', type=float, default=0.0, help='share of "I do not know" (%(default)s)')
    period = number(float, 0, 3600)
    period_help = 'least seconds from turn to turn, not offline (%(default)s)'
    result.add_argument('--turn-period', type=period, default=0.0, help=period_help)
    result.add_argument('--out', type=Path, default=Path('out/demo'), help='folder for the pictures (%(default)s)')
    result.add_argument('--json', type=Path, metavar='FILE', help='write the episode as JSON')
    result.add_argument('--record', type=Path, metavar='BAG', help='record the episode into a new bag, not offline')
    result.add_argument('--namespace', help='of the ROS topics, not offline (one of its own for each run)')
    where = result.add_mutually_exclusive_group()
    where.add_argument('--offline', action='store_true', help='the same episode without ROS')
    where.add_argument('--one-process', action='store_true', help='the ROS nodes in this process, not one process each')
    return result


def main(arguments: Sequence[str]) -> int:
    """Run the demo."""
    given = parser().parse_args(arguments)
    for option in ('record', 'namespace'):
        if given.offline and getattr(given, option):
            raise InputError(f'--{option} is of no use --offline: there is no ROS graph')
    if given.record and given.one_process:
        raise InputError('--record needs a process for each node: leave --one-process out')
    if given.record and given.record.exists():
        raise InputError(f'--record: {given.record} exists already; a bag is never overwritten')
    if given.strategy == 'human' and not (given.offline or given.one_process):
        raise InputError('strategy human reads this terminal: use --offline or --one-process with it')
    choice = WorldChoice(
        load_task(given.task), given.seed, given.seed if given.sample is None else given.sample, given.dataset
    )
    settings = episode_settings(
        choice.task,
        given.strategy,
        given.budget,
        given.turns,
        weights_file=given.weights_file,
        tune_every=given.tune_every,
    )
    teacher = ScriptedTeacher(
        choice.task.symbols, choice.task.relevant_groups, given.seed, given.wrong_rate, given.unknown_rate
    )
    evaluation = Evaluation(choice, settings)
    make_folder(given.out)
    if given.json is not None:
        check_writable(given.json)
    console = Console()
    _tell(console, evaluation.world.report())
    with console.status('preparing the models (compiling them, if need be, takes some ten seconds)'):
        compile_models()
    with Progress(console, choice.task, settings) as progress:
        if given.offline:
            play(evaluation, teacher, progress.after_turn)
        else:
            _play_graph(given, evaluation, progress.after_turn)
    result = evaluation.result()
    # The numbers first: a disk may be full by now.
    console.print(summary(result))
    _tell(console, evaluation.world.report())
    if given.json is not None:
        document = episode_document(result, teacher, evaluation.world)
        write_text(given.json, json.dumps(document, indent=1) + '\n')
    pictures = draw_pictures(result, evaluation.world, given.out)
    for path in (*pictures, *(path for path in (given.json, given.record) if path)):
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    return 0


def _tell(console: Console, notes: str) -> None:
    """Print where the observations come from, before the episode and, as more was read since, after it."""
    if notes:
        console.print(notes, highlight=False, markup=False, soft_wrap=True)


def _play_graph(given: argparse.Namespace, evaluation: Evaluation, watch: TurnWatcher) -> None:
    """Have the ROS nodes play the episode, and measure what they report.

    Raises:
        InputError: ROS is not installed, or the namespace is no namespace.
        EpisodeError: the nodes did not play it to its end.
    """
    try:
        from al_questioner.ros.graph import Graph
        from al_questioner.ros.worlds import new_episode_id
    except ImportError as error:
        raise InputError(
            f'ROS 2 cannot be imported ({error}): install it (pip install ".[ros]"), or use --offline'
        ) from error
    choice, settings = evaluation.choice, evaluation.settings
    world = {'task': given.task, 'dataset': str(given.dataset or ''), 'seed': choice.seed, 'sample': choice.sample}
    episode_id = new_episode_id(choice)

    def follow(turn: int, queries: tuple[QueryRecord, ...]) -> None:
        by_turn = {record.turn: record for record in queries}
        evaluation.correct(queries)
        while evaluation.turn < turn:
            record = by_turn.get(evaluation.turn + 1)
            accuracy = evaluation.next_turn(record)
            watch(evaluation.turn, record, accuracy)

    Graph(
        namespace=(given.namespace or f'demo_{os.getpid()}').strip('/'),
        episode_id=episode_id,
        parameters={
            'perception': world,
            'teacher': {**world, 'wrong_rate': given.wrong_rate, 'unknown_rate': given.unknown_rate},
            'learner': {
                **world,
                'strategy': settings.strategy,
                'budget': settings.budget,
                'turns': settings.turns,
                'weights_file': given.weights_file or '',
                'tune_every': settings.tune_every,
                'turn_period': given.turn_period,
                'episode_id': episode_id,
            },
        },
        one_process=given.one_process,
        log_dir=given.out / 'logs',
        patience=PATIENCE + given.turn_period,
        bag=given.record,
    ).play(follow)
