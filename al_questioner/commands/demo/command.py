"""The `demo` executable."""

from __future__ import annotations

import argparse
import json
import os

from rich.console import Console

from al_questioner.commands.demo.new_table import recognise_new_table
from al_questioner.commands.demo.progress import ProgressView
from al_questioner.commands.demo.report import episode_document, summary
from al_questioner.concepts import compile_models
from al_questioner.domain import InputError, QueryRecord
from al_questioner.questioning import make_strategy
from al_questioner.simulation import (
    Evaluation,
    PerceivedWorld,
    ScriptedTeacher,
    TurnWatcher,
    WorldSpec,
    episode_settings,
    load_task,
    play,
)
from al_questioner.simulation.made_up_world import MadeUpWorld, made_up_scene
from al_questioner.support.files import check_writable, make_folder, write_text
from al_questioner.terminal.menu import make_picker

TEACHER_OPTIONS = ('wrong_rate', 'unknown_rate', 'relevance_omission', 'relevance_false_alarm', 'repeat_shown')
"""Options that are parameters of the scripted teacher."""
PATIENCE = 30.0
"""Seconds without progress after which the warning of a node ends the demo."""


def main(given: argparse.Namespace) -> int:
    """Run the demo."""
    world_spec = WorldSpec(
        load_task(given.task), given.seed, given.seed if given.sample is None else given.sample, given.dataset
    )
    settings = episode_settings(
        world_spec.task,
        given.strategy,
        given.budget,
        given.turns,
        weights_file=given.weights_file,
        carry_labels=given.carry_labels,
    )
    made_up = MadeUpWorld(world_spec.task, world_spec.seed, world_spec.sample) if given.dry_run else None
    views = 'images' if made_up is None else 'made-up views'
    teacher = ScriptedTeacher(
        world_spec.task.symbols,
        world_spec.task.relevant_groups if made_up is None else made_up.relevant_groups,
        given.seed,
        given.wrong_rate,
        given.unknown_rate,
        repeat_shown=given.repeat_shown,
        relevance_omission=given.relevance_omission,
        relevance_false_alarm=given.relevance_false_alarm,
    )
    strategy = make_strategy(settings.strategy, settings.weights, make_picker())
    world = PerceivedWorld(world_spec.open()) if made_up is None else PerceivedWorld(made_up, made_up_scene)
    evaluation = Evaluation(world_spec, settings, strategy.selector, world)
    make_folder(given.out)
    if given.json is not None:
        check_writable(given.json)
    if not given.offline:
        _import_ros()
    console = Console()
    _tell(console, world.report())
    with console.status('preparing the models (compiling them, if need be, takes some ten seconds)'):
        compile_models()
    with ProgressView(console, world_spec.task, settings) as progress:
        if given.offline:
            play(evaluation, strategy, teacher, progress.after_turn)
        else:
            _play_graph(given, evaluation, progress.after_turn)
    result, new_table = evaluation.result(), recognise_new_table(evaluation, world)
    # The numbers first: a disk may be full by now.
    console.print(summary(result, views))
    console.print(str(new_table), highlight=False, soft_wrap=True)
    _tell(console, world.report())
    if given.json is not None:
        document = {
            **episode_document(result, teacher, world),
            'dry_run': given.dry_run,
            'new_table': new_table.members(),
        }
        write_text(given.json, json.dumps(document, indent=1) + '\n')
    # Only now, as matplotlib takes long to import.
    from al_questioner.commands.demo.pictures import draw_pictures

    pictures = draw_pictures(result, new_table, world, given.out, views)
    for path in (*pictures, *(path for path in (given.json, given.record) if path)):
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    return 0


def _tell(console: Console, notes: str) -> None:
    """Print where the observations come from, before the episode and, as more was read since, after it."""
    if notes:
        console.print(notes, highlight=False, markup=False, soft_wrap=True)


def _import_ros() -> None:
    """Have ROS imported, which takes long, before anything is shown.

    Raises:
        InputError: it is not installed.
    """
    try:
        import al_questioner.ros.episode_launcher  # noqa: F401
    except ImportError as error:
        raise InputError(
            f'ROS 2 cannot be imported ({error}): install it (pip install ".[ros]"), or use --offline'
        ) from error


def _play_graph(given: argparse.Namespace, evaluation: Evaluation, watch: TurnWatcher) -> None:
    """Have the ROS nodes play the episode, and measure what they report.

    Raises:
        InputError: the namespace is no namespace.
        EpisodeError: the nodes did not play it to its end.
    """
    from al_questioner.ros.episode_launcher import EpisodeLauncher
    from al_questioner.ros.worlds import new_episode_id

    spec, settings = evaluation.world_spec, evaluation.settings
    world = {'task': given.task, 'dataset': str(given.dataset or ''), 'seed': spec.seed, 'sample': spec.sample}
    episode_id = new_episode_id(spec)

    def follow(turn: int, queries: tuple[QueryRecord, ...]) -> None:
        by_turn = {record.turn: record for record in queries}
        evaluation.correct(queries)
        while evaluation.turn < turn:
            record = by_turn.get(evaluation.turn + 1)
            accuracy = evaluation.next_turn(record)
            watch(evaluation.turn, record, accuracy)

    EpisodeLauncher(
        namespace=(given.namespace or f'demo_{os.getpid()}').strip('/'),
        episode_id=episode_id,
        parameters={
            'perception': world,
            'teacher': {
                **world,
                **{name: getattr(given, name) for name in TEACHER_OPTIONS},
            },
            'learner': {
                **world,
                **{name: getattr(settings, name) for name in ('strategy', 'budget', 'turns', 'carry_labels')},
                'weights_file': given.weights_file or '',
                'turn_period': given.turn_period,
                'episode_id': episode_id,
            },
        },
        one_process=given.one_process,
        log_dir=given.out / 'logs',
        patience=PATIENCE + given.turn_period,
        bag=given.record,
        # What keeps two demos apart while they run says nothing to those who get the bag.
        namespace_in_bag='' if given.namespace else 'demo',
    ).play(follow)
