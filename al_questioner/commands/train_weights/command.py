"""The `train_weights` executable."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich import progress as bars
from rich.console import Console
from rich.table import Table

from al_questioner.bags import digest
from al_questioner.bags.settings import STORAGE_SUFFIXES
from al_questioner.commands.train_weights.query_counts import FreePlay, tell_eagerness, warn_of_classifiers
from al_questioner.domain import InputError
from al_questioner.imitation.assessment import predict_queries
from al_questioner.imitation.bags import read_demonstrations
from al_questioner.imitation.max_entropy_irl import Iteration
from al_questioner.imitation.settings import MatchingSettings, TrainingSettings
from al_questioner.imitation.training import Training, train, validation_text, weights_document
from al_questioner.questioning import FEATURE_SETS, read_weights
from al_questioner.support import strict_yaml
from al_questioner.support.files import check_writable, write_text
from al_questioner.support.text import number_of

ITERATIONS_OF_A_LINE = 5
"""Iterations between two lines of progress, without a terminal to show a bar."""


def main(given: argparse.Namespace) -> int:
    """Learn weights, write them, and show what came of it."""
    console, picture = Console(), given.picture
    _check_replaceable(given.out)
    for path in (given.out, picture):
        check_writable(path)
    paths = _without_other_files(given.bags)
    if len({path.resolve() for path in paths}) < len(paths):
        raise InputError('a bag is named twice')
    left_out: list[str] = []
    demonstrations = read_demonstrations(paths, FEATURE_SETS[given.strategy], left_out, given.classifiers)
    matching = MatchingSettings(given.iterations, given.rollouts, given.patience, given.seed, given.jobs)
    settings = TrainingSettings(given.method, given.validation, given.ridge, matching)
    held_out = settings.held_out_of(len(demonstrations))
    if given.method == 'maxent' and not held_out:
        line = 'no demonstration is held out: nothing will tell whether the weights hold for others'
        console.print(line, soft_wrap=True)
    with bars.Progress(
        bars.TextColumn('iteration {task.completed:.0f}, at most {task.total:.0f}'),
        bars.BarColumn(),
        bars.TextColumn('{task.description}'),
        bars.TimeElapsedColumn(),
        console=console,
        transient=True,
    ) as progress:
        bar = progress.add_task('opening the worlds', total=given.iterations, visible=given.method == 'maxent')

        def watch(iteration: int, state: Iteration) -> None:
            gaps = f'gap {np.linalg.norm(state.gap):.2f}'
            if held_out:
                gaps += f', validation {np.linalg.norm(state.validation_gap):.2f}'
            progress.update(bar, completed=iteration, description=gaps)
            if not console.is_terminal and iteration % ITERATIONS_OF_A_LINE == 0:
                console.print(f'iteration {iteration}, at most {given.iterations}: {gaps}', highlight=False)

        training = train(demonstrations, settings, watch)
    # Only now, as it is no use to anybody whose bags cannot be learnt from.
    for path in (path for path in given.bags if path not in paths):
        console.print(f'{path} is passed over: it is no bag', highlight=False, soft_wrap=True)
    for line in [*left_out, *filter(None, [warn_of_classifiers(demonstrations)])]:
        console.print(f'WARNING: {line}', style='yellow', markup=False, highlight=False, soft_wrap=True)
    recorded, of = (sum(turns) for turns in zip(*((d.turns, d.settings.turns) for d in demonstrations), strict=True))
    played = f'{"" if recorded == of else f"{recorded} of "}{number_of(of, "turn")}'
    console.print(f'{number_of(len(demonstrations), "demonstration")}, {played}')
    bags = [{'name': path.name, 'sha256': digest(path)} for path in paths]
    write_text(given.out, strict_yaml.text_of(weights_document(training, len(demonstrations), bags)))
    # Only now, as matplotlib takes long to import.
    from al_questioner.commands.train_weights.pictures import draw_training

    free, in_place = FreePlay(training, demonstrations), None
    if training.matching is None:
        in_place = [predict_queries(training.weights, demonstration) for demonstration in demonstrations]
    draw_training(training, demonstrations, free.play() if in_place is None else in_place, picture)
    console.print(_table(training))
    console.print(_summary(training), highlight=False)
    if training.matching is not None:
        console.print(validation_text(training, training.matching), highlight=False, soft_wrap=True)
    for line in tell_eagerness(demonstrations, in_place, free):
        console.print(line, highlight=False, soft_wrap=True)
    for path in (given.out, picture):
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    return 0


def _check_replaceable(out: Path) -> None:
    """Check that nothing but earlier weights would be lost.

    Raises:
        InputError: there is another file; a bag's metadata, for example, are YAML as well.
    """
    if not out.is_file() or out.stat().st_size == 0:
        return
    try:
        read_weights(out)
    except InputError as error:
        raise InputError(f'--out: {out} exists and is no weights file ({error}); it is not overwritten') from error


def _without_other_files(paths: Sequence[Path]) -> list[Path]:
    """Drop files that are no bags, such as a README that `bags/*` names too; keep all if nothing is left."""
    kept = [path for path in paths if not path.is_file() or path.suffix in (*STORAGE_SUFFIXES.values(), '.bag')]
    return kept or list(paths)


def _table(training: Training) -> Table:
    table = Table('feature', 'weight', 'gap before', 'gap after')
    columns = (training.weights, training.gap_before, training.gap_after)
    named = [training.by_feature(column, 3) for column in columns]
    for name in named[0]:
        free = ' (not identified)' if name in training.free.unidentified else ''
        table.add_row(name + free, *(f'{column[name]:.3f}' for column in named))
    return table


def _summary(training: Training) -> str:
    before, after = (float(np.linalg.norm(gap)) for gap in (training.gap_before, training.gap_after))
    agreed = training.agreement
    return (
        f"gap {before:.2f} before, {after:.2f} after (units of the features' spread)\n"
        f'agreement with the expert: kind of query {agreed.kind:.2f}, whether to ask {agreed.ask:.2f},'
        f' log-likelihood {agreed.log_likelihood:.2f} a turn\n'
        f'{training.free.describe()}'
    )
