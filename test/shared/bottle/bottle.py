"""One run of the whole graph, from one seed."""

from __future__ import annotations

import random
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from shared.bottle.chart import Chart
from shared.bottle.faults import Faults
from shared.bottle.network import Network
from shared.bottle.promises import BrokenPromiseError
from shared.bottle.robot import STRATEGIES, Plan, Robot
from shared.bottle.scheduler import Scheduler

RATES = {
    'death': 0.01, 'loss': 0.1, 'duplicate': 0.1, 'delay': 0.08, 'reorder': 0.1,
    'clock jumps': 0.3, 'clock drifts': 0.2, 'clock stands': 0.15, 'disk full': 0.1, 'disk read-only': 0.05,
    'person leaves': 0.1, 'garbage': 0.2, 'wrong': 0.15, 'unknown': 0.1, 'skip': 0.1, 'late': 0.1, 'answer twice': 0.2,
    'contradict': 0.15, 'correct': 0.2, 'no picture': 0.1, 'broken cloud': 0.05, 'empty table': 0.03, 'arm': 0.05,
    'sentinel': 0.05, 'undo': 0.2, 'best effort': 0.3, 'burst': 0.05, 'another id': 0.03,
}  # fmt: skip
"""Chance of each kind of fault, each time it could happen, where a run has it at all."""
OTHERS = {'script': 0.4, 'replay': 0.15, 'terminal': 0.3, 'recogniser': 0.15, 'recorder': 0.2, 'rival': 0.1}
"""Share of the runs that have each of these processes."""
SECONDS_OF_FAULTS = 35.0
"""Seconds in which faults happen."""
SECONDS_OF_FAULTS_AFTER_END = 10.0
"""Seconds after the end of the last episode in which faults go on: late answers and corrections still come."""
SECONDS_TO_END = 200.0
"""Seconds within which every episode ends once faults have stopped."""
SECONDS_OF_CALM = 35.0
"""Seconds after that within which all that was said is acknowledged."""
MOST_STEPS = 200_000


@dataclass(frozen=True)
class Outcome:
    """Result of a run.

    Attributes:
        violation: the promise that was broken; empty if none was.
        faults: names of the faults that happened.
        chart: the course of the run, if it was kept.
        steps: actions that were run.
        seconds: virtual seconds.
        lives: starts of learners.
    """

    seed: int
    violation: str
    faults: tuple[str, ...]
    chart: str
    steps: int
    seconds: float
    lives: int


def make_rates(draw: random.Random) -> dict[str, float]:
    """Return the faults of a run: some kinds only, so that rare ones are not drowned by common ones."""
    if draw.random() < 0.05:
        return {}
    return {kind: rate * draw.choice((0.3, 1.0, 3.0)) for kind, rate in RATES.items() if draw.random() < 0.5}


def make_plan(draw: random.Random) -> Plan:
    """Return a layout in which somebody answers."""
    people = tuple(draw.random() < 0.25 for _ in range(draw.choice((0, 0, 1, 1, 2))))
    others = {name for name, share in OTHERS.items() if draw.random() < share}
    noise = draw.choice((None, None, None, 0.0, 0.05))
    if not people and (noise is not None or 'script' not in others):
        # A camera knows no turns, by which the script answers.
        others.add('terminal')
    return Plan(
        seed=draw.randrange(2**31),
        strategy=draw.choice(STRATEGIES),
        turns=draw.randint(3, 7),
        budget=float(draw.randint(2, 10)),
        things=draw.randint(2, 5),
        interval=draw.randint(1, 4),
        noise=noise,
        people=people,
        others=frozenset(others),
        keeps_log=draw.random() > (0.1 if people else 0.5),
        answer_timeout=draw.choice((0.0, 5.0, 30.0)),
        turn_period=draw.choice((0.0, 0.0, 1.0)),
        slowness=draw.choice((1.0, 1.0, 50.0)),
    )


def run(
    seed: int, allowed: frozenset[str] | None = None, is_charted: bool = False, replay_rate: float = 0.05
) -> Outcome:
    """Play a run to its end, or to the first promise that is broken.

    Args:
        seed: what happens.
        allowed: the only faults that may happen; None for all that the seed has.
        is_charted: whether to take down the course of it.
        replay_rate: share of the states that are compared with a replay of the log.
    """
    draw = random.Random(seed)
    faults = Faults(seed, make_rates(draw), allowed)
    scheduler = Scheduler()
    chart = Chart(lambda: scheduler.now, is_charted)
    network = Network(scheduler, faults, chart)
    names = ['a', 'b'] if draw.random() < 0.15 else ['a']
    robots = [Robot(name, make_plan(draw), scheduler, network, faults, chart, replay_rate) for name in names]
    violation = ''
    try:
        _play(robots, scheduler, faults)
    except BrokenPromiseError as error:
        violation = str(error)
    except Exception as error:  # noqa: BLE001 - an error that nobody foresaw is what is looked for
        last = traceback.extract_tb(error.__traceback__)[-1]
        violation = f'{type(error).__name__}: {error} ({Path(last.filename).name}, line {last.lineno})'
    if violation:
        chart.note('', violation)
    lives = sum(robot.learner.lives for robot in robots)
    return Outcome(seed, violation, tuple(faults.happened), chart.text, scheduler.steps, scheduler.now, lives)


def _play(robots: list[Robot], scheduler: Scheduler, faults: Faults) -> None:
    """Play until faults stop, then until all episodes are over, then until nothing is under way any more."""

    def is_over() -> bool:
        return all(robot.promises.is_done for robot in robots)

    def step_until(end: float, is_enough: Callable[[], bool] = lambda: False) -> None:
        while scheduler.now < end and scheduler.steps < MOST_STEPS and not is_enough() and scheduler.step():
            pass

    step_until(SECONDS_OF_FAULTS, is_over)
    step_until(min(SECONDS_OF_FAULTS, scheduler.now + SECONDS_OF_FAULTS_AFTER_END))
    faults.active = False
    for robot in robots:
        robot.calm()
    step_until(scheduler.now + SECONDS_TO_END, is_over)
    step_until(scheduler.now + SECONDS_OF_CALM)
    for robot in robots:
        robot.check_end()
