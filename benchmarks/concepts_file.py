"""Size of a concepts file, and the time to write, to read, and to learn again what it holds.

    python benchmarks/concepts_file.py [--days N] [--seed SEED]

An episode of value_per_cost at the budget and the turns of each task, without ROS, then others that each begin with the
file of the last one, in other samples of the world. A row holds what is in the file after the first and after the last.
To learn again is what a learner does that begins with the file, once, and a recogniser.
"""

from __future__ import annotations

import argparse
import time
from collections import deque
from collections.abc import Callable
from typing import TypeVar

from measuring import print_table

from al_questioner.domain import Knowledge, random_stream
from al_questioner.messages.concepts_file import concepts_of_text
from al_questioner.messages.concepts_text import concepts_text
from al_questioner.messages.knowledge_members import forget_written
from al_questioner.questioning import Episode
from al_questioner.questioning.review import taught_learner
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task, turns

TASKS = ('prepare_lunch', 'pack_lunchbox', 'kitchen_table')
Result = TypeVar('Result')


def known_after(task_name: str, day: int, seed: int, before: Knowledge | None) -> Knowledge:
    """Return what is known after an episode that began with what was known before."""
    task, sample = load_task(task_name), seed + day
    settings = episode_settings(task, 'value_per_cost', concepts=before)
    episode = Episode(settings, random_stream(sample, 'learner'))
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, sample)
    deque(turns(episode, PerceivedWorld(WorldSpec(task, sample, sample).open()), teacher), maxlen=0)
    return episode.knowledge(f'{task_name} {day}')


def timed(job: Callable[[], Result]) -> tuple[Result, float]:
    """Return the result of a job, and the seconds that it took."""
    start = time.perf_counter()
    result = job()
    return result, time.perf_counter() - start


def measured(days: int, knowledge: Knowledge) -> list[str]:
    """Return the row of a file."""
    forget_written()
    text, writing = timed(lambda: concepts_text(knowledge))
    known, reading = timed(lambda: concepts_of_text(text))
    _, learning = timed(lambda: taught_learner(known))
    counts = str(days), str(len(known.views)), str(len(known.examples)), f'{len(text) / 1000:.0f}'
    return [*counts, *(f'{1000 * seconds:.0f}' for seconds in (writing, reading, learning))]


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('--days', type=int, default=8, help='episodes one after another; default %(default)s')
    parser.add_argument('--seed', type=int, default=1000, help='sample of the first one; default %(default)s')
    given = parser.parse_args()
    rows = []
    for task in TASKS:
        known = None
        for day in range(1, given.days + 1):
            known = known_after(task, day, given.seed, known)
            if day in (1, given.days):
                rows.append([task, *measured(day, known)])
    columns = ('task', 'episodes', 'views', 'examples', 'kB', 'write, ms', 'read, ms', 'learn again, ms')
    print_table('Concepts files', columns, rows)


if __name__ == '__main__':
    main()
