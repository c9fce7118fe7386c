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
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.task import Future
from std_msgs.msg import String

from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from shared.checkout import ROOT

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
        self.processes: list[subprocess.Popen[bytes]] = []
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

    def start_process(self, program: Sequence[object], log: Path, **parameters: Any) -> subprocess.Popen[bytes]:
        """Start a node in a process and a session of its own, in the graph's namespace.

        Args:
            program: what Python is to run.
            log: takes what it prints.
            parameters: of the node.
        """
        command = [sys.executable, *map(str, program), '--ros-args', '-r', f'__ns:=/{self.namespace}']
        for parameter, value in parameters.items():
            command += ['-p', f'{parameter}:={json.dumps(value)}']
        inherited = {**of_a_child(), 'ROS_DOMAIN_ID': str(self.context.get_domain_id())}
        with log.open('wb') as out:
            process = subprocess.Popen(
                command,
                env=inherited,
                stdin=subprocess.DEVNULL,
                stdout=out,
                stderr=out,
                start_new_session=True,
            )
        self.processes.append(process)
        return process

    def start_robot(self, **learner: Any) -> None:
        """Perception and a learner, whose parameters may differ from those of `episode`."""
        self.start(PerceptionNode, **self.world)
        self.start(LearnerNode, **{**self.episode, **learner})

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
        for process in self.processes:
            kill(process)
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


class Processes:
    """Processes in sessions of their own and in a namespace that nobody else uses, all gone after the test."""

    def __init__(self, folder: Path) -> None:
        self.namespace = f'test_{uuid.uuid4().hex[:12]}'
        self._folder = folder
        self._running: dict[str, subprocess.Popen[bytes]] = {}

    def run(self, *arguments: str) -> subprocess.CompletedProcess[str]:
        """An executable of the package, to its end."""
        command = al_questioner(*arguments)
        return subprocess.run(command, env=of_a_child(), capture_output=True, text=True, timeout=DEADLINE, check=False)

    def start(self, name: str, command: list[str], typed: Path | None = None) -> subprocess.Popen[bytes]:
        """Any command; what it prints goes to a log of this name, what it reads comes from a file."""
        with self.log_path(name).open('wb') as log, (typed or Path(os.devnull)).open('rb') as source:
            self._running[name] = subprocess.Popen(
                command,
                env=of_a_child(),
                stdin=source,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )
        return self._running[name]

    def node(self, name: str, typed: Path | None = None, **parameters: object) -> subprocess.Popen[bytes]:
        """A node of the package with these parameters."""
        arguments = ['--ros-args', '-r', f'__ns:=/{self.namespace}']
        for key, value in parameters.items():
            arguments += ['-p', f'{key}:={json.dumps(value)}']
        return self.start(name, al_questioner(name, *arguments), typed)

    def log_path(self, name: str) -> Path:
        """The file of a log."""
        return self._folder / f'{name}.log'

    def log(self, name: str) -> str:
        """What a process has printed so far."""
        return self.log_path(name).read_text()

    def wait_for_log(self, name: str, text: str) -> None:
        """Wait until a process has printed something.

        Raises:
            AssertionError: it ended, or did not print it before the deadline.
        """
        end = time.monotonic() + DEADLINE
        while text not in self.log(name):
            assert time.monotonic() < end, f'{name} never printed {text!r}: {self.log(name)}'
            assert self._running[name].poll() is None, f'{name} ended: {self.log(name)}'
            time.sleep(0.05)

    def close(self) -> None:
        """End everything."""
        for process in self._running.values():
            if process.poll() is None:
                kill(process)


def of_a_child() -> dict[str, str]:
    """The environment: this checkout comes first."""
    path = os.pathsep.join(filter(None, (str(ROOT), os.environ.get('PYTHONPATH'))))
    return {**os.environ, 'PYTHONPATH': path}


def al_questioner(*arguments: str) -> list[str]:
    """The command that runs an executable of the package."""
    return [sys.executable, '-m', 'al_questioner', *arguments]


def kill(process: subprocess.Popen[bytes]) -> None:
    """End a process, if it has not ended, as a crash would."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.wait()


@pytest.fixture
def graph() -> Iterator[Graph]:
    context = Context()
    context.init(domain_id=1 + os.getpid() % 100)
    result = Graph(context)
    try:
        yield result
    finally:
        result.close()
        context.try_shutdown()


@pytest.fixture
def processes(tmp_path: Path) -> Iterator[Processes]:
    result = Processes(tmp_path)
    try:
        yield result
    finally:
        result.close()
