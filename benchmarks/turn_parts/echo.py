"""A process that sends back what it hears, and the time that takes: transport without any work.

Run as a program it is that process. Its node takes messages as the nodes of the graph do: the executor hands them to a
worker thread, which publishes.
"""

from __future__ import annotations

import os
import queue
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from measuring import Seconds
from rclpy.context import Context
from rclpy.node import Node
from turn_parts.recording import spinning
from turn_parts.topics import TYPES

from al_questioner.domain import EpisodeError
from al_questioner.ros import qos
from al_questioner.ros.episode_launcher import stop
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.running import spin_node

SECONDS_TO_APPEAR = 60.0
SECONDS_TO_ANSWER = 60.0
WARM_UP = 10


class EchoNode(QuestionerNode):
    """Publishes on `pong_TOPIC` what comes on `ping_TOPIC`."""

    def __init__(self, **node_arguments: Any) -> None:
        super().__init__('echo', **node_arguments)
        for topic, message_type in TYPES.items():
            publisher = self.create_publisher(message_type, f'pong_{topic}', qos.EVENTS)
            self.on_message(message_type, f'ping_{topic}', publisher.publish, qos.EVENTS)


@dataclass(frozen=True, eq=False)
class Hop:
    """Sending one message to another process.

    Attributes:
        there: (repeats,) seconds from one process to the other, half of a round trip.
        publishing: (repeats,) seconds that the sender's call of `publish` took, which is a part of it.
    """

    there: Seconds
    publishing: Seconds


def measure_hops(namespace: str, messages: Mapping[str, Any], repeats: int) -> dict[str, Hop]:
    """Send a message of each topic to another process and back.

    Raises:
        EpisodeError: the other process does not answer.
    """
    command = [sys.executable, '-m', 'turn_parts.echo', '--ros-args', '-r', f'__ns:=/{namespace}']
    here = str(Path(__file__).resolve().parents[1])
    environment = {**os.environ, 'PYTHONPATH': os.pathsep.join(filter(None, (here, os.environ.get('PYTHONPATH'))))}
    quiet = subprocess.DEVNULL
    process = subprocess.Popen(
        command, env=environment, stdin=quiet, stdout=quiet, stderr=quiet, start_new_session=True
    )
    try:
        with spinning(context := Context()) as executor:
            node = Node('caller', namespace=namespace, context=context)
            executor.add_node(node)
            returned: queue.SimpleQueue[Any] = queue.SimpleQueue()
            publishers = {}
            for topic in messages:
                publishers[topic] = node.create_publisher(TYPES[topic], f'ping_{topic}', qos.EVENTS)
                node.create_subscription(TYPES[topic], f'pong_{topic}', returned.put, qos.EVENTS)
            executor.wake()
            return {
                topic: _measure(publisher, messages[topic], returned, repeats)
                for topic, publisher in publishers.items()
            }
    finally:
        stop([process])


def _measure(publisher: Any, message: Any, returned: queue.SimpleQueue[Any], repeats: int) -> Hop:
    there, publishing = np.empty(WARM_UP + repeats), np.empty(WARM_UP + repeats)
    _await_first(publisher, message, returned)
    for i in range(WARM_UP + repeats):
        start = time.perf_counter()
        publisher.publish(message)
        publishing[i] = time.perf_counter() - start
        try:
            returned.get(timeout=SECONDS_TO_ANSWER)
        except queue.Empty:
            raise EpisodeError('the echo process fell silent') from None
        there[i] = (time.perf_counter() - start) / 2
    return Hop(there[WARM_UP:], publishing[WARM_UP:])


def _await_first(publisher: Any, message: Any, returned: queue.SimpleQueue[Any]) -> None:
    """Send until both directions have found each other, and then let everything that was sent come back."""
    end = time.monotonic() + SECONDS_TO_APPEAR
    sent, back = 0, 0
    while back < sent or sent == 0:
        if time.monotonic() > end:
            raise EpisodeError('the echo process does not answer')
        if back == 0:
            publisher.publish(message)
            sent += 1
        try:
            returned.get(timeout=0.2)
            back += 1
        except queue.Empty:
            # What was sent before the two met is lost.
            if back:
                return


if __name__ == '__main__':
    spin_node(EchoNode, sys.argv[1:])
