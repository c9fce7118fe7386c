"""A robot of real processes, and somebody who listens to it, answers, and wants things."""

from __future__ import annotations

import contextlib
import json
import os
import shlex
import signal
import subprocess
import sys
import time
import uuid
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import rclpy
from std_msgs.msg import String

from al_questioner.domain import Answer, EpisodeError, Query
from al_questioner.messages import documents
from al_questioner.ros import qos

PATIENCE = 120.0
"""Seconds after which something that does not happen is given up; far more than anything here takes."""
AGAIN_AFTER = 1.0
"""Seconds after which something that nobody has heard is said again."""


class Robot:
    """Processes in a namespace of their own, each in a session of its own; what is left is killed at the end.

    Args:
        folder: where the processes run, and where their logs are written.
        show: is given each command as a person types it.
    """

    def __init__(self, folder: Path, show: Callable[[str], None]) -> None:
        self._folder, self._show = folder, show
        self._namespace = f'story_{uuid.uuid4().hex[:12]}'
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._node = rclpy.create_node('listener', namespace=self._namespace)
        self._heard: dict[str, list[Any]] = {}
        self._recognised_at: list[Mapping[str, int]] = []
        self._mouths = {name: self._node.create_publisher(String, name, qos.EVENTS) for name in ('answer', 'want')}
        for name in ('query', 'learner_state', 'recognition'):
            self._listen(name, qos.LATCHED)
        for name in ('answer_ack', 'target_info'):
            self._listen(name, qos.EVENTS)

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.kill()
        self._node.destroy_node()

    def start(self, name: str, **parameters: object) -> None:
        """Start a node of the package with these parameters."""
        given = [word for key, value in parameters.items() for word in ('-p', f'{key}:={_yaml(value)}')]
        self._start(name, [sys.executable, '-m', 'al_questioner', name], given)

    def start_script(self, path: Path, *arguments: str) -> None:
        """Start a script that is a node."""
        self._start(path.stem, [sys.executable, str(path), *arguments], [])

    def kill(self, *names: str) -> None:
        """End some processes, or all, at once, as a power cut does."""
        self._end([self._processes.pop(name) for name in names or tuple(self._processes)], signal.SIGKILL)

    def stop(self) -> None:
        """End all processes as Ctrl-C does.

        Raises:
            EpisodeError: one of them does not end cleanly.
        """
        ended, self._processes = self._processes, {}
        self._end(tuple(ended.values()), signal.SIGINT)
        for name, process in ended.items():
            if process.returncode != 0:
                raise EpisodeError(f'{name} ended with status {process.returncode}: {self._log(name).read_text()}')

    def query(self, number: int) -> Query:
        """Wait for the question of this number."""
        asked = self._heard['query']
        self._wait_for(lambda: asked and asked[-1]['query_id'] == f'q{number}', f'question {number}')
        return documents.query_of(asked[-1])

    def tell(self, answer: Answer) -> None:
        """Answer, until it is acknowledged: then the answer is on the disk.

        Raises:
            EpisodeError: it is refused.
        """
        episode_id = self._heard['query'][-1]['episode_id']
        message = documents.write('answer', episode_id, documents.answer_members(answer))
        acks = self._heard['answer_ack']
        ack = self._say('answer', message, lambda: acks and acks[-1]['query_id'] == answer.query_id and acks[-1])
        if not ack['accepted']:
            raise EpisodeError(f'the answer to {answer.query_id} was refused: {ack["reason"]}')

    def wait_for_end(self) -> Mapping[str, Any]:
        """Wait until the learner is done, and return its last state."""
        states = self._heard['learner_state']
        return self._wait_for(lambda: states and states[-1]['done'] and states[-1], 'the end of the episode')

    def recognition(self) -> Mapping[str, Any]:
        """Wait until a cloud that was not there before is recognised, and return that."""
        heard, before = self._heard['recognition'], self._recognised_at
        found = self._wait_for(lambda: heard and heard[-1]['stamp'] not in before and heard[-1], 'a recognition')
        # A cloud can be heard, and told of, more than once.
        before.append(found['stamp'])
        return found

    def want(self, text: str) -> Mapping[str, Any]:
        """Ask for something, and return where it is, or why there is none."""
        answers = self._heard['target_info']
        answers.clear()
        return self._say('want', text, lambda: answers and answers[-1])

    def _start(self, name: str, command: list[str], ros: list[str]) -> None:
        options = ['--ros-args', *ros] if ros else []
        self._show(f'python {shlex.join([*command[1:], *options])} &')
        everything = [*command, '--ros-args', '-r', f'__ns:=/{self._namespace}', *ros]
        with self._log(name).open('ab') as log:
            # A pipe that nobody writes to: a script that reads its input would end at the end of it.
            self._processes[name] = subprocess.Popen(
                everything, cwd=self._folder, stdin=subprocess.PIPE, stdout=log, stderr=log, start_new_session=True
            )

    def _log(self, name: str) -> Path:
        return self._folder / f'{name}.log'

    @staticmethod
    def _end(processes: Sequence[subprocess.Popen[bytes]], number: signal.Signals) -> None:
        for process in processes:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(process.pid, number)
        for process in processes:
            process.wait(PATIENCE)
            if process.stdin is not None:
                process.stdin.close()

    def _listen(self, name: str, profile: Any) -> None:
        heard: list[Any] = self._heard.setdefault(name, [])
        self._node.create_subscription(String, name, lambda message: heard.append(json.loads(message.data)), profile)

    def _say(self, topic: str, text: str, is_answered: Callable[[], Any]) -> Any:
        """Say something until it is answered, and return the answer."""
        mouth, last = self._mouths[topic], 0.0

        def say_again() -> Any:
            nonlocal last
            if mouth.get_subscription_count() and time.monotonic() > last + AGAIN_AFTER:
                last = time.monotonic()
                mouth.publish(String(data=text))
            return is_answered()

        return self._wait_for(say_again, f'an answer on {topic} to {text[:40]}')

    def _wait_for(self, find: Callable[[], Any], what: str) -> Any:
        """Hear until something is found, and return it.

        Raises:
            EpisodeError: it is not found in time, or a process has ended.
        """
        end = time.monotonic() + PATIENCE
        while not (found := find()):
            rclpy.spin_once(self._node, timeout_sec=0.05)
            for name, process in self._processes.items():
                if process.poll() is not None:
                    raise EpisodeError(f'{name} ended: {self._log(name).read_text()}')
            if time.monotonic() > end:
                raise EpisodeError(f'waited {PATIENCE:g} s without success for {what}')
        return found


def _yaml(value: object) -> str:
    return value if isinstance(value, str) else json.dumps(value)
