"""Detection of a careless teacher among careful ones by the learner.

    python benchmarks/reliability.py [--task TASK] [--strategy NAME] [--samples N] [--budget B] [--turns T]

For each share of wrong answers, over N samples (seeds 1000 and up), the estimated reliability after the episode, as
mean and standard deviation, beside the share of the named things that were named rightly: first of a teacher who
speaks alone, then of one with whom a careful colleague, who answers too late, agrees or does not.
"""

from __future__ import annotations

import argparse
import dataclasses
from collections.abc import Iterator

import numpy as np
from measuring import print_table

from al_questioner.domain import Outcome, QueryKind, random_stream
from al_questioner.questioning import Episode
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task

WRONG_RATES = (0.0, 0.1, 0.3, 0.5)


def play(given: argparse.Namespace, sample: int, wrong_rate: float, colleague: bool) -> tuple[float, float]:
    """Estimated and actual reliability of a teacher after an episode."""
    task = load_task(given.task)
    world = PerceivedWorld(WorldSpec(task, sample, sample).open())
    own = episode_settings(task, given.strategy, given.budget, given.turns)
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, sample, wrong_rate, teacher_id='tested')
    careful = ScriptedTeacher(task.symbols, task.relevant_groups, sample, teacher_id='careful')
    episode, right = Episode(own, random_stream(sample, 'learner')), []
    for turn in range(1, own.turns + 1):
        query = episode.ask(world.scene(turn)).query
        if query is None:
            continue
        truth = world.truth(turn)
        record = episode.tell(teacher.answer(query, truth))
        if colleague and query.action.kind is QueryKind.LABEL:
            late = careful.answer(query, truth)
            episode.keep_late(dataclasses.replace(late, answer_id=f'{late.answer_id}/late'))
        if record.outcome is Outcome.ANSWERED and record.object_id is not None and record.symbol is not None:
            right.append(truth[record.object_id] == record.symbol)
    return episode.teachers['tested'].reliability, float(np.mean(right))


def rows(given: argparse.Namespace) -> Iterator[list[str]]:
    """One row for each share of wrong answers."""
    for colleague in (False, True):
        for rate in WRONG_RATES:
            played = [play(given, 1000 + number, rate, colleague) for number in range(given.samples)]
            estimated, actual = np.array(played).T
            yield [
                'with a careful colleague' if colleague else 'alone',
                f'{rate:g}',
                f'{actual.mean():.3f}',
                f'{estimated.mean():.3f} ± {estimated.std():.3f}',
            ]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--task', default='prepare_lunch')
    parser.add_argument('--strategy', default='u_sampling_fsq')
    parser.add_argument('--samples', type=int, default=10)
    parser.add_argument('--budget', type=float, default=150.0)
    parser.add_argument('--turns', type=int, default=150)
    given = parser.parse_args()
    title = f'{given.task}, {given.strategy}, {given.samples} samples'
    print_table(title, ['teacher', 'wrong answers', 'named rightly', 'estimated'], list(rows(given)))


if __name__ == '__main__':
    main()
