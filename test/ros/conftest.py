"""Nodes in this process and in others, and somebody who listens to them, all gone after the test."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
import time
import uuid
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import String

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode

DEADLINE = 90.0
"""Seconds after which a test gives up; far more than anything here takes."""


class Graph:
    """The nodes of a test, in a namespace that nobody else uses.

    Attributes:
        world, episode: parameters of perception, and of a learner that asks a few questions.
    """

    world: Mapping[str, Any] = MappingProxyType({'task': 'prepare_lunch', 'seed': 4})
    episode: Mapping[str, Any] = MappingProxyType({**world, 'budget': 6.0, 'turns': 8, 'strategy': 'random_fsq'})

    def __init__(self, context: Context) -> None:
        self.namespace = f'test_{uuid.uuid4().hex[:12]}'
        self.context = context
        self.executor = SingleThreadedExecutor(context=context)
        self.heard: dict[str, list[Any]] = {}
        self.nodes: list[Node] = []
        self._changed = threading.Condition()
        self.ears = Node('ears', namespace=self.namespace, context=context)
        self.executor.add_node(self.ears)
        self._ended = Future(executor=self.executor)
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def start(self, make: Callable[..., Node], **parameters: Any) -> Node:
        """A node with these parameters, spinning; `namespace` chooses another namespace than the graph's."""
        namespace = parameters.pop('namespace', self.namespace)
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        node = make(namespace=namespace, context=self.context, parameter_overrides=overrides)
        self.nodes.append(node)
        self.executor.add_node(node)
        return node

    def start_robot(self, **learner: Any) -> None:
        """Perception and a learner, whose parameters may differ from those of `episode`."""
        self.start(PerceptionNode, **self.world)
        self.start(LearnerNode, **{**self.episode, **learner})

    def play(self, **learner: Any) -> dict[str, Any]:
        """Return the final state of such a learner beside the scripted teacher."""
        states = self.listen('learner_state')
        self.start_robot(**learner)
        self.start(TeacherNode, **self.world)
        return self.wait_for_end(states)

    def wait_for_end(self, states: list[Any]) -> dict[str, Any]:
        """Wait until the learner whose states are heard is done, and return its last state."""
        self.wait_for(lambda: states and states[-1]['done'], 'the end of the episode')
        return states[-1]

    def stop(self, node: Node) -> None:
        """End one node."""
        self.nodes.remove(node)
        self.executor.remove_node(node)
        # In the thread that spins, which may still be looking at what the node has.
        destroyed = self.executor.create_task(node.destroy_node)
        self.wait_for(destroyed.done, 'the end of a node')

    def listen(
        self, kind: str, message_type: type = String, profile: Any = None, topic: str | None = None
    ) -> list[Any]:
        """The list that messages of a topic are added to; documents already parsed."""
        heard = self.heard.setdefault(kind, [])

        def hear(message: Any) -> None:
            with self._changed:
                is_document = isinstance(message, String) and message.data.startswith('{')
                heard.append(json.loads(message.data) if is_document else message)
                self._changed.notify_all()

        self.ears.create_subscription(message_type, topic or kind, hear, profile or qos.LATCHED)
        self.executor.wake()
        return heard

    def wait_for(self, is_true: Callable[[], Any], what: str) -> Any:
        """Wait until something holds, and return it.

        Raises:
            AssertionError: it did not come to hold before the deadline.
        """
        end = time.monotonic() + DEADLINE
        while not (value := is_true()):
            with self._changed:
                self._changed.wait(0.02)
            if time.monotonic() > end:
                raise AssertionError(f'waited {DEADLINE:g} s without success for {what}')
        return value

    def close(self) -> None:
        """End everything."""
        # The executor destroys in its shutdown what the thread that spins would still be waiting for.
        self._ended.set_result(None)
        self._thread.join(5)
        self.executor.shutdown()
        for node in (*self.nodes, self.ears):
            node.destroy_node()

    def _spin(self) -> None:
        try:
            self.executor.spin_until_future_complete(self._ended)
        except ExternalShutdownException:
            return


class Diagnostics:
    """The diagnostics of all nodes."""

    def __init__(self, graph: Graph) -> None:
        self._graph = graph
        self._heard = graph.listen('/diagnostics', DiagnosticArray, qos.DIAGNOSTICS)

    @property
    def statuses(self) -> list[DiagnosticStatus]:
        """All that were told, in order."""
        return [status for array in self._heard for status in array.status]

    @property
    def values(self) -> dict[str, str]:
        """The values that were told last."""
        return {value.key: value.value for status in self.statuses for value in status.values}

    def tell(self, text: str, *levels: bytes) -> bool:
        """Return whether some status has this text, and one of these levels, if any are given."""
        return any(text in s.message and (not levels or s.level in levels) for s in self.statuses)

    def wait_for(self, text: str, *levels: bytes) -> None:
        """Wait until that is so."""
        self._graph.wait_for(lambda: self.tell(text, *levels), text)


class Person:
    """Somebody with `ros2 topic pub`, `ros2 topic echo` and patience."""

    def __init__(self, graph: Graph) -> None:
        self.graph = graph
        self.queries, self.states = map(graph.listen, ('query', 'learner_state'))
        self.acks = graph.listen('answer_ack', profile=qos.EVENTS)
        self.mouth = graph.ears.create_publisher(String, 'answer', qos.EVENTS)

    def query(self, number: int) -> dict[str, Any]:
        """The query of this number, once it is asked."""
        self.graph.wait_for(lambda: self.queries and self.queries[-1]['query_id'] == f'q{number}', f'query {number}')
        return self.queries[-1]

    def says(self, text: str) -> dict[str, Any]:
        """Say something, and hear whether it was taken."""
        before = len(self.acks)
        self.graph.wait_for(self.mouth.get_subscription_count, 'a learner that listens')
        self.mouth.publish(String(data=text))
        self.graph.wait_for(lambda: len(self.acks) > before, f'an acknowledgement of {text[:40]!r}')
        return self.acks[-1]


class Processes:
    """Processes in sessions of their own and in a namespace that nobody else uses, all gone after the test."""

    def __init__(self, folder: Path) -> None:
        self.namespace = f'test_{uuid.uuid4().hex[:12]}'
        self._folder = folder
        self._running: dict[str, subprocess.Popen[bytes]] = {}

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """An executable of the package, to its end."""
        return subprocess.run(al_questioner(*arguments), capture_output=True, text=True, timeout=DEADLINE, check=False)

    def start(self, name: str, command: list[str], typed: Path | None = None) -> subprocess.Popen[bytes]:
        """Any command; what it prints goes to a log of this name, what it reads comes from a file."""
        with self.log_path(name).open('wb') as log, (typed or Path(os.devnull)).open('rb') as source:
            self._running[name] = subprocess.Popen(
                command, stdin=source, stdout=log, stderr=subprocess.STDOUT, start_new_session=True
            )
        return self._running[name]

    def node(
        self, name: str, typed: Path | None = None, program: list[str] | None = None, **parameters: object
    ) -> subprocess.Popen[bytes]:
        """A node of the package with these parameters, run by its executable or by another program."""
        arguments = ['--ros-args', '-r', f'__ns:=/{self.namespace}']
        for key, value in parameters.items():
            arguments += ['-p', f'{key}:={json.dumps(value)}']
        return self.start(name, [*(program or al_questioner(name)), *arguments], typed)

    def is_running(self, name: str) -> bool:
        return self._running[name].poll() is None

    def kill(self, name: str) -> None:
        """End a process, if it has not ended, as a crash would."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self._running[name].pid, signal.SIGKILL)
        self._running[name].wait()

    def log_path(self, name: str) -> Path:
        """The file of a log."""
        return self._folder / f'{name}.log'

    def log(self, name: str) -> str:
        """Return all that a process has printed so far."""
        return self.log_path(name).read_text()

    def wait_for_log(self, name: str, text: str, may_be_killed: bool = False) -> bool:
        """Wait until a process has printed something; false if it was killed before, and may be.

        Raises:
            AssertionError: it ended otherwise, or did not print it before the deadline.
        """
        end = time.monotonic() + DEADLINE
        while text not in self.log(name):
            assert time.monotonic() < end, f'{name} never printed {text!r}: {self.log(name)}'
            status = self._running[name].poll()
            if may_be_killed and status == -signal.SIGKILL:
                return text in self.log(name)
            assert status is None, f'{name} ended: {self.log(name)}'
            time.sleep(0.02)
        return True

    def close(self) -> None:
        """End everything, and print the logs, which are shown if the test has failed."""
        for name in self._running:
            sys.stdout.write(f'{name}, {"running" if self.is_running(name) else "ended"}: {self.log(name)}\n')
            self.kill(name)


def al_questioner(*arguments: str) -> list[str]:
    """The command that runs an executable of the package."""
    return [sys.executable, '-m', 'al_questioner', *arguments]


@pytest.fixture
def graph() -> Iterator[Graph]:
    context = Context()
    context.init(domain_id=int(os.environ['ROS_DOMAIN_ID']))
    result = Graph(context)
    try:
        yield result
    finally:
        result.close()
        context.try_shutdown()


@pytest.fixture
def diagnostics(graph: Graph, monkeypatch: pytest.MonkeyPatch) -> Diagnostics:
    """The diagnostics of all nodes that start from now on, told more often than usual."""
    monkeypatch.setattr('al_questioner.ros.node.DIAGNOSTICS_PERIOD', 0.1)
    return Diagnostics(graph)


@pytest.fixture
def person(graph: Graph) -> Person:
    return Person(graph)


@pytest.fixture
def processes(tmp_path: Path) -> Iterator[Processes]:
    result = Processes(tmp_path)
    try:
        yield result
    finally:
        result.close()
