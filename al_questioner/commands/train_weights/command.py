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
from al_questioner.bags.storages import STORAGE_SUFFIXES
from al_questioner.domain import InputError, QueryRecord
from al_questioner.imitation.assessment import imitate, predict_queries
from al_questioner.imitation.bags import read_demonstrations
from al_questioner.imitation.demonstration import Demonstration
from al_questioner.imitation.feature_matching import Iteration
from al_questioner.imitation.settings import MatchingSettings, TrainingSettings
from al_questioner.imitation.training import Training, train, validation_text, weights_document
from al_questioner.questioning import FEATURE_SETS, read_weights
from al_questioner.simulation import PerceivedWorld
from al_questioner.support import strict_yaml
from al_questioner.support.files import check_writable, write_text
from al_questioner.support.text import number_of

ITERATIONS_OF_A_LINE = 5
"""Where there is no terminal to show a bar."""

TIMID = 0.5
"""Share of the expert's questions below which learnt weights are warned of."""


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
    demonstrations = read_demonstrations(paths, FEATURE_SETS[given.strategy], left_out)
    matching = MatchingSettings(given.iterations, given.rollouts, given.patience, given.seed, given.jobs)
    settings = TrainingSettings(given.method, given.validation, given.ridge, matching)
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
            gap, held_out = np.linalg.norm(state.gap), np.linalg.norm(state.validation_gap)
            gaps = f'gap {gap:.2f}, validation {held_out:.2f}'
            progress.update(bar, completed=iteration, description=gaps)
            if not console.is_terminal and iteration % ITERATIONS_OF_A_LINE == 0:
                console.print(f'iteration {iteration}, at most {given.iterations}: {gaps}', highlight=False)

        training = train(demonstrations, settings, watch)
    # Only now, as it is no use to anybody whose bags cannot be learnt from.
    for path in (path for path in given.bags if path not in paths):
        console.print(f'{path} is passed over: it is no bag', highlight=False, soft_wrap=True)
    for line in left_out:
        console.print(f'WARNING: {line}', style='yellow', markup=False, highlight=False, soft_wrap=True)
    played = number_of(sum(d.turns for d in demonstrations), 'turn')
    console.print(f'{number_of(len(demonstrations), "demonstration")}, {played}')
    bags = [{'name': path.name, 'sha256': digest(path)} for path in paths]
    write_text(given.out, strict_yaml.text_of(weights_document(training, len(demonstrations), bags)))
    # Only now, as matplotlib takes long to import.
    from al_questioner.commands.train_weights.pictures import draw_training

    learner = _learner(training, demonstrations)
    draw_training(training, demonstrations, learner, picture)
    console.print(_table(training))
    console.print(_summary(training), highlight=False)
    if training.matching is not None:
        console.print(validation_text(training, training.matching), highlight=False, soft_wrap=True)
    _compare_eagerness(console, demonstrations, learner)
    for path in (given.out, picture):
        console.print(f'  {path}', highlight=False, soft_wrap=True)
    return 0


def _check_replaceable(out: Path) -> None:
    """See that nothing but weights of before would be lost.

    Raises:
        InputError: there is another file; a bag's metadata, for example, are YAML as well.
    """
    if not out.is_file() or out.stat().st_size == 0:
        return
    try:
        read_weights(out)
    except InputError as error:
        raise InputError(f'--out: {out} exists and is no weights file ({error}); it is not overwritten') from error


def _compare_eagerness(
    console: Console, demonstrations: Sequence[Demonstration], learner: Sequence[Sequence[QueryRecord]]
) -> None:
    """Say how much the learner asks beside the expert: softmax agrees with an expert whom the best choice does not."""
    asked = sum(map(len, learner))
    by_expert = sum(len(demonstration.queries) for demonstration in demonstrations)
    console.print(
        f'the learner, who takes the best candidate, asks {number_of(asked, "question")}; the expert asked {by_expert}',
        highlight=False,
        soft_wrap=True,
    )
    if asked < TIMID * by_expert:
        console.print('[yellow]WARNING: with these weights it hardly asks; they are of little use[/yellow]')


def _without_other_files(paths: Sequence[Path]) -> list[Path]:
    """The paths without files that are no bags, such as a README that `bags/*` names too; all if nothing is left."""
    kept = [path for path in paths if not path.is_file() or path.suffix in (*STORAGE_SUFFIXES.values(), '.bag')]
    return kept or list(paths)


def _learner(training: Training, demonstrations: Sequence[Demonstration]) -> list[tuple[QueryRecord, ...]]:
    """What the learner asks in the expert's place: by itself, or, without a simulator, in the expert's states."""
    if training.matching is None:
        return [predict_queries(training.weights, demonstration) for demonstration in demonstrations]
    found = []
    for demonstration in demonstrations:
        if demonstration.world is not None:
            world = PerceivedWorld(demonstration.world.open())
            found.append(imitate(training.weights, demonstration, world).queries)
    return found


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
