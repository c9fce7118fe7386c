"""Nodes whose clock is a topic: it jumps, goes back, stands still, and shows impossible times."""

from __future__ import annotations

import time
from typing import Any

from builtin_interfaces.msg import Time
from diagnostic_msgs.msg import DiagnosticStatus
from rclpy.qos import QoSProfile
from rosgraph_msgs.msg import Clock

from al_questioner.bags import read_bag
from al_questioner.bags.playback import Playback
from al_questioner.messages.stamps import SECOND
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.replayer import ReplayNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.running import Spinner
from shared.bags import SHIPPED

SIMULATED = {'use_sim_time': True}


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
