"""A learner that runs for days keeps what it has seen and been told, and nothing else."""

from __future__ import annotations

import tracemalloc

import pytest

from al_questioner.domain import AUTO, EpisodeSettings, Scene
from al_questioner.event_log.durable_episode import DurableEpisode
from al_questioner.event_log.events import EpisodeStarted
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.learner import LearnerMachine, LearnerOptions
from al_questioner.questioning import make_strategy
from shared.bottle.looks import look_of
from shared.bottle.table import SYMBOLS, Table
from shared.machine_driver import Driver

TURNS = 10_000
BYTES_A_TURN = 300
"""Memory of a turn in which nothing changed: its stamp, and a reference to its scene."""


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_ten_thousand_turns_fill_no_memory() -> None:
    """Otherwise a robot in a home would end one night for want of memory."""
    settings = EpisodeSettings(SYMBOLS, 5.0, TURNS + 1, 'random_fsq')
    started = EpisodeStarted('e', settings, 1, AUTO, None, 'x')
    machine = LearnerMachine(DurableEpisode(started, make_strategy('random_fsq', {}), None), None, LearnerOptions())
    driver, scene = Driver(machine), Table(3, 5).scene(0)
    driver.start()

    def play(turns: int) -> None:
        for _ in range(turns):
            _answer_turn(driver, scene)

    play(TURNS // 2)
    tracemalloc.start()
    before = tracemalloc.take_snapshot()
    play(TURNS // 2)
    grown = [each for each in tracemalloc.take_snapshot().compare_to(before, 'lineno') if each.size_diff > 0]
    tracemalloc.stop()
    total = sum(each.size_diff for each in grown)
    largest = '\n'.join(map(str, sorted(grown, key=lambda each: -each.size_diff)[:5]))
    assert total / (TURNS // 2) < BYTES_A_TURN, largest
    assert len(driver.timers) < 5


def _answer_turn(driver: Driver, scene: Scene) -> None:
    """Show the scene of the turn that is asked for, and answer what is asked."""
    turn = driver.published('turn')[-1]
    query_before = driver.published('query')[-1:]
    driver.seconds += 0.1
    driver.hear('objects', look_of(scene, stamp_of(turn['stamp'])))
    asked = driver.published('query')[-1:]
    if asked != query_before:
        word = asked[0]['choices'][0]
        driver.hear('answer', word)
    driver.done = driver.done[-40:]
