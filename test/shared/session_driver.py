"""A session of a learner in one process, which is killed at its write points or at any time, and goes on.

    PYTHONPATH=test python -m shared.session_driver points FOLDER | relevance FOLDER | random FOLDER KILLS SEED

writes one JSON object to the standard output; `relevance` is `points` with a person who asks which things matter. A
script, so that it forks before anything has threads.
"""

from __future__ import annotations

import dataclasses
import json
import os
import random
import signal
import sys
import time
from collections.abc import Callable
from functools import cache, lru_cache, partial
from pathlib import Path

from al_questioner.domain import Answer, Outcome, Query, Scene
from al_questioner.event_log.events import EpisodeStarted, SceneObserved
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.questioning import Receipt
from al_questioner.simulation import PerceivedWorld, WorldSpec, episode_settings
from shared.durable_sessions import TASK, TEACHER, WITH_RELEVANCE, ask_what_matters, durable_of
from shared.storages import WatchedStorage, killer

SETTINGS = episode_settings(TASK, 'u_sampling_fsq', 6.0, 5, change_interval=2)
BEGUN = EpisodeStarted('e1', SETTINGS, 4, 1e-3, None, '0')


@lru_cache(maxsize=1)
def world() -> PerceivedWorld:
    return PerceivedWorld(WorldSpec(TASK, 4, 4).open())


@cache
def scene(turn: int) -> Scene:
    return world().scene(turn)


def said(query: Query) -> list[Answer]:
    """All that is said while a query is pending, in order; the last answers it, and much is said twice."""
    answer = TEACHER.answer(query, world().truth(query.turn))
    number = int(query.query_id[1:])
    if number == 1:
        return [answer]
    before = f'q{number - 1}'
    late = Answer(before, f'{before}/bert', 'bert', Outcome.SKIP)
    undo = Answer(before, f'{before}/undo', 'scripted', Outcome.UNKNOWN, replaces=f'{before}/scripted')
    return [late, late, *([undo, undo] if number % 2 else []), answer]


def is_away(query: Query, turn: int) -> bool:
    """Return whether nobody answers a query in a turn: the third one waits for a turn."""
    return query.query_id == 'q3' and turn == query.turn


def play(folder: Path, acknowledge: Callable[[Answer], None], at_write_point: Callable[[str], None]) -> None:
    """The episode to its end, from wherever its log is; the rules are those of the learner node."""
    log = SessionLog(folder, partial(WatchedStorage, reached=at_write_point))
    is_person = sys.argv[1] == 'relevance'
    begun = dataclasses.replace(BEGUN, settings=WITH_RELEVANCE) if is_person else BEGUN
    durable = durable_of(begun, log, ask_what_matters if is_person else None)
    durable.start()
    episode = durable.episode
    while True:
        if episode.awaited is not None and is_away(episode.awaited, episode.turn):
            durable.time_out()
        elif episode.awaited is not None:
            for answer in said(episode.awaited):
                if durable.take(answer).receipt is not Receipt.LATE:
                    acknowledge(answer)
        if episode.done:
            break
        turn = episode.turn + 1
        durable.ask(SceneObserved(turn, turn * 1000, 'table', scene(turn)))
    durable.close()


def run(folder: Path, kill_at: int = 0, kill_after: float | None = None) -> bool:
    """Play in a child; whether it came to its end."""
    child = os.fork()
    if child == 0:
        acknowledged = os.open(folder.with_suffix('.acks'), os.O_WRONLY | os.O_CREAT | os.O_APPEND)

        def acknowledge(answer: Answer) -> None:
            os.write(acknowledged, f'{answer.query_id} {answer.answer_id}\n'.encode())

        play(folder, acknowledge, killer(kill_at))
        os._exit(0)
    if kill_after is not None:
        time.sleep(kill_after)
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) == signal.SIGKILL:
        return False
    if status != 0:
        raise SystemExit(f'a learner failed at write point {kill_at}')
    return True


def lines(folder: Path) -> list[tuple[str, bytes]]:
    contents = read_log(folder)
    if contents.damage:
        raise SystemExit(f'{folder}: {contents.damage}')
    return [(event.kind, event.content) for event in contents.events]


def faults(folder: Path, whole: list[tuple[str, bytes]], finished: bool) -> list[str]:
    """Return the faults of a log, against that of the undisturbed session."""
    there = lines(folder)
    found = [] if there == (whole if finished else whole[: len(there)]) else [f'{folder.name}: other events']
    taken = [json.loads(content) for kind, content in there if kind in ('answer', 'correction')]
    ids = [f'{answer["query_id"]} {answer["answer_id"]}' for answer in taken]
    if len(set(ids)) < len(ids):
        found.append(f'{folder.name}: an answer counts twice')
    acks = folder.with_suffix('.acks')
    missing = set(acks.read_text().splitlines()) - set(ids) if acks.exists() else set()
    if missing:
        found.append(f'{folder.name}: acknowledged and lost: {missing}')
    return found


def main() -> None:
    mode, root = sys.argv[1], Path(sys.argv[2])
    # Here, so that no child has to look at the scenes and to make ready what computes.
    play(root / 'first', lambda _: None, lambda _: None)
    began = time.monotonic()
    run(root / 'whole')
    duration = time.monotonic() - began
    whole = lines(root / 'whole')
    problems, kills = faults(root / 'whole', whole, True), 0
    if mode in ('points', 'relevance'):
        for point in range(1, 1000):
            folder = root / f'point-{point}'
            if run(folder, kill_at=point):
                break
            kills += 1
            if (folder / 'session.sqlite3').exists():
                problems += faults(folder, whole, False)
            if point % 4 == 0:
                # Once more, soon after it has gone on.
                kills += not run(folder, kill_at=1 + point // 4 % 7)
            run(folder)
            problems += faults(folder, whole, True)
    else:
        draw, number = random.Random(int(sys.argv[4])), 0
        while kills < int(sys.argv[3]):
            number += 1
            folder = root / f'random-{number}'
            while not run(folder, kill_after=draw.uniform(0, duration)):
                kills += 1
                if (folder / 'session.sqlite3').exists():
                    problems += faults(folder, whole, False)
            problems += faults(folder, whole, True)
    kinds = [kind for kind, _ in whole]
    counts = {kind: kinds.count(kind) for kind in kinds}
    sys.stdout.write(json.dumps({'kills': kills, 'problems': problems, 'kinds': counts, 'seconds': duration}))


if __name__ == '__main__':
    main()
