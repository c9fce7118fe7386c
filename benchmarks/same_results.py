"""The results that a user gets, written down to check that a change of the code changes none of them.

    python benchmarks/same_results.py write FOLDER      with the old code, and with the new code
    python benchmarks/same_results.py compare BEFORE AFTER

It writes, all offline: ten episodes of each strategy on the three simulated tables (JSON), weights learnt from the
shipped bags by both methods, what `replay --check` says of these bags, the log of a session with late, corrected and
refused answers, its exports and its bag, and the demo's output and pictures. It takes some ten minutes. `compare`
prints a line for each kind, and ends with 1 if a file differs in a byte, or is missing.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import itertools
import sqlite3
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from unittest import mock

from al_questioner.cli import main as run
from al_questioner.domain import Answer, Outcome
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import SessionLog
from al_questioner.questioning import STRATEGIES, make_strategy
from al_questioner.simulation import PerceivedWorld, ScriptedTeacher, WorldSpec, episode_settings, load_task
from al_questioner.support.configuration import named_bag

TASKS = ('prepare_lunch', 'pack_lunchbox', 'kitchen_table')
BAGS = ('expert_0', 'expert_1', 'expert_2')
SEEDS = range(10)
FIRST_MOMENT_NS = 1_700_000_000 * 10**9
"""Since the epoch, of the session: a second more with every event."""


def write_episodes(folder: Path) -> None:
    """Episodes as the demo's JSON; a person cannot be played."""
    for task, strategy, seed in itertools.product(TASKS, sorted(set(STRATEGIES) - {'human'}), SEEDS):
        kept = folder / f'{task}-{strategy}-{seed}.json'
        # The pictures are those of the last one.
        options = [f'--task={task}', f'--strategy={strategy}', f'--seed={seed}', f'--out={folder.parent / "pictures"}']
        capture(['demo', '--offline', *options, '--json', str(kept)])


def write_demo(folder: Path) -> None:
    """The pictures of the default demo, and what it prints."""
    text = capture(['demo', '--offline', '--out', str(folder), '--json', str(folder / 'episode.json')])
    (folder / 'printed.txt').write_text(text.replace(str(folder), 'FOLDER'))


def write_training(folder: Path) -> None:
    """Weights by both methods, and whether the bags lead to their decisions."""
    for method in ('maxent', 'choice'):
        options = ['--method', method, '--iterations', '5', '--rollouts', '4', '--jobs', '1']
        capture(['train_weights', *BAGS, *options, '--out', str(folder / f'{method}.yaml')])
    checks = ''.join(capture(['replay', bag, '--check']) for bag in BAGS)
    (folder / 'checks.txt').write_text(checks.replace(str(named_bag(BAGS[0]).parent), 'BAGS'))


def write_session(folder: Path) -> None:
    """A session's log as SQL, its exports, and what can be read of its bag."""
    task = load_task('prepare_lunch')
    world = PerceivedWorld(WorldSpec(task, 4, 4).open())
    teacher = ScriptedTeacher(task.symbols, task.relevant_groups, 4)
    members = {'task': 'prepare_lunch', 'seed': 4, 'sample': 4, 'dataset': None}
    settings = episode_settings(task, 'dt_task_env', 12.0, 16)
    moments = itertools.count(FIRST_MOMENT_NS, 10**9)
    with mock.patch('time.time_ns', moments.__next__):
        started = EpisodeStarted('e1', settings, 4, 1e-3, members, '1')
        strategy = make_strategy(settings.strategy, settings.weights)
        durable = DurableEpisode(started, strategy, SessionLog(folder / 'log'))
        durable.start()
        while not durable.episode.done:
            turn = durable.episode.turn + 1
            durable.ask(SceneObserved(turn, turn * 10**9, 'table', world.scene(turn)))
            # One that nobody has answered waits for the next turn.
            query = durable.episode.awaited
            if query is not None and turn % 5 == 0:
                durable.time_out()
            elif query is not None:
                durable.take(teacher.answer(query, world.truth(turn)))
                durable.take(teacher.answer(query, world.truth(turn)))
        durable.take(Answer('q1', 'b1', 'bert', Outcome.SKIP))
        durable.take(Answer('q1', 'c1', 'scripted', Outcome.UNKNOWN, replaces='q1/scripted'))
        durable.note_rejected('pudding', 'it does not answer')
        durable.close()
    with contextlib.closing(sqlite3.connect(folder / 'log' / 'session.sqlite3')) as database:
        (folder / 'log.sql').write_text('\n'.join(database.iterdump()))
    exports = ['--json', str(folder / 'session.json'), '--csv', str(folder / 'csv'), '--bag', str(folder / 'bag')]
    text = capture(['session', str(folder / 'log'), *exports])
    (folder / 'printed.txt').write_text(text.replace(str(folder), 'FOLDER'))
    (folder / 'check.txt').write_text(
        capture(['replay', str(folder / 'bag'), '--check']).replace(str(folder), 'FOLDER')
    )


def capture(arguments: Sequence[str]) -> str:
    """Return what an executable prints.

    Raises:
        SystemExit: it failed.
    """
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        status = run(list(arguments))
    if status:
        raise SystemExit(f'{" ".join(arguments)}: status {status}')
    return printed.getvalue()


KINDS = {'demo': write_demo, 'session': write_session, 'training': write_training, 'episodes': write_episodes}
"""The folders, and what writes each."""


def write(folder: Path) -> None:
    """Write all there is to be compared."""
    for kind, write_kind in KINDS.items():
        begin = time.monotonic()
        (folder / kind).mkdir(parents=True)
        write_kind(folder / kind)
        print(f'{kind}: {len(files(folder / kind))} files, {time.monotonic() - begin:.0f} s', flush=True)


def files(folder: Path) -> set[Path]:
    """The files below a folder, by their names there."""
    return {path.relative_to(folder) for path in folder.rglob('*') if path.is_file()}


def compare(before: Path, after: Path) -> int:
    """Print how many files of each kind are the same, and return the number of others."""
    found = 0
    for kind in KINDS:
        names = files(before / kind) | files(after / kind)
        others = sorted(name for name in names if content(before / kind / name) != content(after / kind / name))
        found += len(others)
        print(f'{kind}: {len(names) - len(others)} of {len(names)} files are the same to the byte')
        for name in others:
            print(f'  {name} differs')
    return found


def content(path: Path) -> bytes | None:
    """Of a file; None if there is none."""
    return path.read_bytes() if path.is_file() else None


def main() -> int:
    """Write, or compare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest='command', required=True)
    commands.add_parser('write').add_argument('folder', type=Path)
    comparing = commands.add_parser('compare')
    comparing.add_argument('before', type=Path)
    comparing.add_argument('after', type=Path)
    given = parser.parse_args()
    if given.command == 'write':
        write(given.folder.resolve())
        return 0
    return 1 if compare(given.before, given.after) else 0


if __name__ == '__main__':
    sys.exit(main())
