"""Unusual scenes of a camera, and clocks that jump, before a learner."""

from __future__ import annotations

import dataclasses
import random
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from al_questioner.domain import Scene, SceneError
from al_questioner.messages.stamps import SECOND, stamp_of
from al_questioner.protocol.events import Event, Moment
from al_questioner.protocol.learner import LearnerOptions
from al_questioner.protocol.topics import Look
from al_questioner.simulation import PerceivedWorld, episode_settings
from shared.learner_robot import Robot
from shared.lunches import TASK
from shared.machine_driver import Driver
from shared.offline import offline_queries

NAMES = ('colour_hue', 'size_height')


def scene(count: int) -> Scene:
    """A scene of this number of things."""
    features = np.random.default_rng(count).random((count, len(NAMES)), np.float32)
    return Scene(tuple(range(count)), np.zeros((count, 3), np.float32), features, NAMES)


@pytest.mark.parametrize('strategy', ['value_per_cost', 'dt_task_env', 'random_fsq', 'u_sampling'])
def test_an_empty_table_is_a_turn_in_which_nothing_is_asked_about_things(
    make: Callable[..., Robot], tmp_path: Path, strategy: str
) -> None:
    """Otherwise a table that is cleared would stop the episode, until it is laid again."""
    settings = episode_settings(TASK, strategy, 6.0, 6)
    robot = make(tmp_path, settings=settings)
    counts = {1: 0, 2: 4, 3: 0, 4: 5, 5: 0, 6: 5}
    for count in counts.values():
        robot.sees(scene=scene(count))
        if robot.durable.episode.awaits_answer:
            kind = robot.said('query')[-1]['kind']
            assert robot.says('colour' if kind == 'feature_subset' else 'none')['accepted']
    states = robot.said('learner_state')
    assert states[-1]['done']
    asked = Counter(query['turn'] for query in states[-1]['queries'] if query['kind'] != 'feature_subset')
    assert asked.keys() <= {2, 4, 6}
    assert {state['turn']: len(state['beliefs']) for state in states} == counts
    robot.machine.close()
    again = make(tmp_path, settings=settings)
    assert again.durable.episode.turn == 6
    assert again.said('learner_state')[-1] == states[-1]


def test_a_wrong_reading_of_a_thing_that_stands_still_is_named(make: Callable[..., Robot]) -> None:
    """Otherwise nobody would look for the loose cable: the learner keeps the earlier reading in silence."""
    robot = make(settings=episode_settings(TASK, 'random_fsq', 0.0, 4))
    still = scene(6)
    wrong = still.features.copy()
    wrong[4, 1] = 65535
    for features in (still.features, still.features, wrong, wrong):
        robot.sees(scene=dataclasses.replace(still, features=features))
    assert robot.machine.measurements()['implausible size_height'] == '65535 of object 4'
    lines = [line for line in robot.driver.lines if 'reads 65535, far from all else it ever read' in line]
    assert len(lines) == 1


def test_an_unusable_scene_is_refused_and_the_turn_goes_on(make: Callable[..., Robot]) -> None:
    """Otherwise one bad frame of a camera would end the episode, or be learnt from."""

    def unreadable(_: Sequence[str]) -> Scene:
        raise SceneError('a reading is not finite')

    robot = make()
    stamp = stamp_of(robot.said('turn')[0]['stamp'])
    robot.driver.hear('objects', Look(stamp, 'table', unreadable))
    assert robot.driver.refusals == [('objects', 'a reading is not finite')]
    assert robot.said('query') == []
    robot.sees()
    assert len(robot.said('query')) == 1


def test_the_largest_object_id_is_as_good_as_any(make: Callable[..., Robot]) -> None:
    """Otherwise an id that a tracker gives, and a cloud can hold, would stall the learner."""
    robot = make(settings=episode_settings(TASK, 'u_sampling', 6.0, 3))
    largest = dataclasses.replace(scene(3), object_ids=(0, 1, 2**32 - 2))
    robot.sees(scene=largest)
    (made,) = robot.said('decision')
    assert 2**32 - 2 in {action.object_id for action in made.decision.candidates}
    assert robot.says('snack')['accepted']


def test_the_last_scene_of_another_learner_is_not_taken_for_ones_own(
    make: Callable[..., Robot], world: PerceivedWorld
) -> None:
    """Otherwise the latched scene of the last episode's last turn would be taken for the first of the next."""
    first = make()
    first.plays()
    last = stamp_of(first.said('turn')[-1]['stamp'])
    second = Robot(world, None, first.durable.started.settings, LearnerOptions())
    second.driver.seconds = first.driver.seconds + 1
    second.driver.start()
    second.sees(stamp=last)
    assert second.said('query') == second.driver.refusals == []
    assert second.plays() == first.said('learner_state')[-1]['queries']


def show_time(driver: Driver, clock: int) -> None:
    """Have the clock of the robot show this from now on, in nanoseconds."""

    def tell(event: Event) -> None:
        driver.perform(driver.machine.handle(event, Moment(driver.seconds, clock)))

    driver.tell = tell


def test_a_jumping_clock_changes_nothing_that_is_asked(make: Callable[..., Robot]) -> None:
    """A simulation that is started again, or garbage on /clock, neither ends the episode nor mixes up its turns."""
    robot, draw = make(), random.Random(1)
    while not robot.durable.episode.done:
        for act in (robot.sees, robot.is_taught):
            show_time(robot.driver, round(SECOND * draw.choice((0, draw.uniform(0, 100), draw.uniform(0, 2e9)))))
            if act == robot.sees or robot.durable.episode.awaits_answer:
                act()
    assert robot.said('learner_state')[-1]['queries'] == offline_queries('farthest_fsq', 6.0, 8)
    stamps = {turn['turn']: stamp_of(turn['stamp']) for turn in robot.said('turn')}
    grown = [stamps[turn] for turn in sorted(stamps)]
    assert grown == sorted(set(grown))


def test_a_camera_is_seen_again_after_its_clock_went_back(make: Callable[..., Robot]) -> None:
    """Otherwise the robot would look at nothing until the clock has caught up, and not say why."""
    robot = make(settings=episode_settings(TASK, 'u_sampling', 6.0, 5))
    robot.sees()
    robot.is_taught()
    before = stamp_of(robot.said('turn')[-1]['stamp'])
    show_time(robot.driver, 10 * SECOND)
    for seconds in (0.0, 2.0, 4.0):
        robot.driver.seconds = seconds
        robot.sees(stamp=before - 1)
    ((topic, reason),) = robot.driver.refusals
    assert topic == 'objects'
    assert 'our clock has gone back' in reason
    assert len(robot.said('query')) == 1
    show_time(robot.driver, 10 * SECOND + 2)
    robot.sees(stamp=10 * SECOND + 1)
    assert len(robot.said('query')) == 2
    robot.is_taught()
    assert stamp_of(robot.said('turn')[-1]['stamp']) > before
