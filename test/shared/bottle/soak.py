"""Many runs, one seed after the other, on all processors; what this code has done already is not done again.

    PYTHONPATH=test python -m shared.bottle.soak SEEDS [--first SEED] [--processes N] [--state FILE]

The exit status is 1 if a promise was broken, with the shortest course of events that breaks it for each of the first.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import al_questioner
from shared.bottle.bottle import Outcome, run
from shared.bottle.failing import explain

MOST_EXPLAINED = 3
SECONDS_BETWEEN_SAVES = 5.0


def play(seeds: Sequence[int], processes: int) -> Iterator[Outcome]:
    """Play runs side by side; their outcomes, in the order of the seeds."""
    if processes == 1:
        yield from map(run, seeds)
        return
    with multiprocessing.get_context('spawn').Pool(processes) as pool:
        yield from pool.imap(run, seeds, chunksize=8)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog='soak', description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument('seeds', type=int, help='number of runs')
    parser.add_argument('--first', type=int, default=0, help='first seed')
    parser.add_argument('--processes', type=int, default=os.cpu_count() or 1)
    parser.add_argument('--state', type=Path, help='file that remembers how far it came, to go on later')
    given = parser.parse_args(arguments)
    code = digest_of_code()
    done, failed = _remembered(given.state, given.first, code)
    seeds = range(given.first + done, given.first + given.seeds)
    faults = steps = 0
    seconds, began, saved = 0.0, time.monotonic(), time.monotonic()
    for outcome in play(seeds, given.processes):
        done += 1
        faults, steps, seconds = faults + len(outcome.faults), steps + outcome.steps, seconds + outcome.seconds
        if outcome.violation:
            failed.append(outcome.seed)
            _tell(f'seed {outcome.seed}: {outcome.violation}')
        if time.monotonic() > saved + SECONDS_BETWEEN_SAVES or done == given.seeds:
            saved = time.monotonic()
            _remember(given.state, {'code': code, 'first': given.first, 'done': done, 'failed': failed})
            _tell(f'{done} of {given.seeds} seeds, {len(failed)} failed, {saved - began:.0f} s')
    before = given.seeds - len(seeds)
    earlier = f', {before} were played before by this code' if before else ''
    _tell(
        f'{len(seeds)} seeds in {time.monotonic() - began:.0f} s on {given.processes} processors{earlier}:'
        f' {seconds / 3600:.1f} hours of virtual time, {steps} steps, {faults} faults;'
        f' {len(failed)} of {done} seeds break a promise'
    )
    for seed in failed[:MOST_EXPLAINED]:
        _tell(explain(run(seed)))
    return 1 if failed else 0


def digest_of_code() -> str:
    """Return a digest of all that a run depends on: another code has to be tried again from the first seed."""
    found = hashlib.sha256()
    for folder in (Path(al_questioner.__file__).parent, Path(__file__).parent):
        for path in sorted(folder.rglob('*.py')):
            found.update(path.read_bytes())
    return found.hexdigest()[:16]


def _remembered(state: Path | None, first: int, code: str) -> tuple[int, list[int]]:
    """Return how many seeds were done before by this code, and which of them failed."""
    if state is None or not state.exists():
        return 0, []
    members = json.loads(state.read_text(encoding='utf-8'))
    is_same = (members['first'], members['code']) == (first, code)
    return (members['done'], members['failed']) if is_same else (0, [])


def _remember(state: Path | None, members: dict[str, Any]) -> None:
    if state is not None:
        state.parent.mkdir(parents=True, exist_ok=True)
        state.write_text(json.dumps(members), encoding='utf-8')


def _tell(text: str) -> None:
    sys.stdout.write(f'{text}\n')
    sys.stdout.flush()


if __name__ == '__main__':
    sys.exit(main())
