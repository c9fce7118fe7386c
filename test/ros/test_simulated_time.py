"""Nodes whose clock is a topic: it jumps, goes back, stands still, and shows impossible times."""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Iterator
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import PointCloud2

from al_questioner.bags import read_bag
from al_questioner.bags.playback import Playback
from al_questioner.messages.clouds import cloud_of_scene
from al_questioner.messages.stamps import SECOND, stamp_of
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.replayer import ReplayNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.running import Spinner
from al_questioner.ros.types import CLOUD_TYPES, header
from al_questioner.simulation import PerceivedWorld, WorldSpec, load_task
from shared.bags import SHIPPED
from shared.offline import offline_queries

SIMULATED = {'use_sim_time': True}


class SimulatedClock:
    """A clock on /clock, for the nodes of this test's domain."""

    def __init__(self, graph: Any) -> None:
        self._graph = graph
        self._out = graph.ears.create_publisher(Clock, '/clock', QoSProfile(depth=10))

    def show(self, seconds: float) -> None:
        stamp = round(seconds * SECOND)
        self._out.publish(Clock(clock=Time(sec=stamp // SECOND, nanosec=stamp % SECOND)))

    def set(self, node: Any, seconds: float) -> None:
        """Show a time until a node has seen it."""

        def seen() -> bool:
            self.show(seconds)
            return node.get_clock().now().nanoseconds == round(seconds * SECOND)

        self._graph.wait_for(seen, f'time {seconds}')


@pytest.fixture
def clock(graph: Any) -> SimulatedClock:
    return SimulatedClock(graph)


@pytest.fixture
def jumping(clock: SimulatedClock) -> Iterator[None]:
    """Has the clock jump all the time, in a thread of its own."""
    ended = threading.Event()

    def jump() -> None:
        draw = random.Random(1)
        while not ended.wait(0.005):
            clock.show(draw.choice((0, draw.uniform(0, 100), draw.uniform(0, 2e9), 2**31 - 0.5)))

    thread = threading.Thread(target=jump)
    thread.start()
    yield
    ended.set()
    thread.join()


def test_a_jumping_clock_changes_nothing_that_is_asked(graph: Any, jumping: None) -> None:
    """A simulation that is started again, or garbage on /clock, neither ends the episode nor mixes up its turns."""
    states, turns = graph.listen('learner_state'), graph.listen('turn', profile=qos.RECORDED_LATCHED)
    graph.start(PerceptionNode, **graph.world, **SIMULATED)
    graph.start(TeacherNode, **graph.world, **SIMULATED)
    graph.start(LearnerNode, **graph.episode, **SIMULATED, turn_period=0.02)
    assert graph.wait_for_end(states)['queries'] == offline_queries('random_fsq', 6.0, 8)
    stamps = {turn['turn']: stamp_of(turn['stamp']) for turn in turns}
    grown = [stamps[turn] for turn in sorted(stamps)]
    assert grown == sorted(set(grown))


def test_a_camera_is_seen_again_after_its_clock_went_back(
    graph: Any, person: Any, diagnostics: Any, clock: SimulatedClock
) -> None:
    """Otherwise the robot would look at nothing until the clock has caught up, and not say why."""
    queries, turns = person.queries, person.turns
    eyes = graph.ears.create_publisher(PointCloud2, 'objects', qos.LATCHED)
    scene = PerceivedWorld(WorldSpec(load_task('prepare_lunch'), 4, 4).open()).scene(1)

    def look(seconds: float) -> None:
        eyes.publish(cloud_of_scene(scene, header(round(seconds * SECOND), 'camera'), CLOUD_TYPES))

    learner = graph.start(LearnerNode, **{**graph.episode, 'strategy': 'u_sampling'}, **SIMULATED)
    graph.wait_for(lambda: turns, 'the first turn')
    clock.set(learner, 1000.0)
    graph.wait_for(lambda: eyes.get_subscription_count(), 'a learner that looks')
    look(1000.0)
    person.query(1)
    assert person.says('snack')['accepted']
    graph.wait_for(lambda: turns[-1]['turn'] == 2, 'the second turn')
    clock.set(learner, 10.0)

    def reported() -> bool:
        look(999.0)
        return diagnostics.tell('our clock has gone back')

    graph.wait_for(reported, 'a reason on /diagnostics')
    assert {query['query_id'] for query in queries} == {'q1'}
    clock.set(learner, 10.2)
    look(10.1)
    person.query(2)
    stamps = [stamp_of(turn['stamp']) for turn in turns]
    assert stamps == sorted(stamps)
    assert learner.counts().keys() == {'refused on objects'}


def test_a_bag_that_loops_is_seen_in_every_round(graph: Any, diagnostics: Any) -> None:
    """Otherwise a learner that is tried out on a looping bag would stop at the end of the first round."""
    states = graph.listen('learner_state')
    bag = read_bag(SHIPPED)
    span = (bag.messages[-1].stamp - bag.messages[0].stamp) / SECOND
    playback = Playback(bag.messages, rate=span / 0.5, loop=True)
    graph.start(
        lambda **arguments: ReplayNode(bag, playback, 5.0, 200.0, **arguments), namespace=f'{graph.namespace}/past'
    )
    remapped = ['--ros-args', '-r', 'objects:=past/objects']
    graph.start(
        lambda **arguments: LearnerNode(cli_args=remapped, **arguments),
        **{**graph.episode, **SIMULATED, 'seed': 0, 'strategy': 'u_sampling', 'turns': 5, 'turn_period': 0.4},
    )
    graph.start(TeacherNode, task='prepare_lunch', seed=0)
    graph.wait_for_end(states)
    assert not diagnostics.tell('', DiagnosticStatus.ERROR)


def test_a_time_before_the_beginning_of_time_ends_no_node(graph: Any) -> None:
    """Otherwise one message on /clock would end every node that listens to it."""
    looks: list[bool] = []
    end = time.monotonic() + 60.0

    def has_seen_seven() -> bool:
        looks.append(out.get_subscription_count() > 0)
        out.publish(Clock(clock=Time(sec=-5 if sum(looks) < 20 else 7)))
        assert time.monotonic() < end
        return bool(node.get_clock().now().nanoseconds == 7 * SECOND)

    with Spinner(['--ros-args', '-p', 'use_sim_time:=true']) as spinner:
        node = spinner.add(lambda: PerceptionNode(namespace=graph.namespace))
        out = node.create_publisher(Clock, '/clock', QoSProfile(depth=10))
        spinner.spin(has_seen_seven)
    assert looks
