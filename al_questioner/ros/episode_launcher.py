"""Perception, learner and teacher brought up together for one episode, as processes or in this process."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from rclpy.exceptions import NameValidationException
from rclpy.parameter import Parameter
from rclpy.validate_namespace import validate_namespace

from al_questioner.domain import EpisodeError, InputError
from al_questioner.protocol.observer import StateWatcher
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.observer import ObserverNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from al_questioner.ros.parameters import Value
from al_questioner.ros.running import Spinner
from al_questioner.support.files import make_folder

NODES: Mapping[str, Callable[..., QuestionerNode]] = {
    'perception': PerceptionNode,
    'teacher': TeacherNode,
    'learner': LearnerNode,
}
SECONDS_TO_STOP = 10.0
"""Seconds after which a process that was asked to stop is killed."""


@dataclass(frozen=True)
class EpisodeLauncher:
    """Launcher of the nodes of one episode.

    Attributes:
        namespace: of all their topics, without a slash at its ends.
        episode_id: of the episode that is played.
        parameters: of each node, by its name.
        one_process: run the nodes in this process instead of one process each.
        log_dir: where each process leaves what it prints.
        patience: seconds without progress after which a warning on /diagnostics is taken for the end.
        bag: where a recorder beside them writes the episode to; None for no recorder. Not in one process.
        namespace_in_bag: of the topics in the bag; empty for that of the nodes.
    """

    namespace: str
    episode_id: str
    parameters: Mapping[str, Mapping[str, Value]]
    one_process: bool
    log_dir: Path
    patience: float
    bag: Path | None = None
    namespace_in_bag: str = ''

    def play(self, watch: StateWatcher) -> None:
        """Play an episode to its end.

        Args:
            watch: called on the states of the learner, from a thread of its own.

        Raises:
            InputError: a namespace or a parameter that cannot be used.
            EpisodeError: a process ended before the episode did, or this one was told to.
            KeyboardInterrupt: it was interrupted, and all processes have ended.
        """
        try:
            validate_namespace(f'/{self.namespace}')
        except NameValidationException as error:
            raise InputError(' '.join(str(error).split())) from error
        interrupted, is_done = threading.Event(), False
        # The recorder first: the others wait for it.
        names = (*(() if self.bag is None else ('record',)), *NODES)
        with self._processes(() if self.one_process else names) as processes, Spinner([], interrupted) as spinner:
            observer = spinner.add(
                lambda: ObserverNode(self.episode_id, watch, self.patience, namespace=self.namespace)
            )
            if self.one_process:
                for name in NODES:
                    spinner.add(self._maker(name))

            def is_over() -> bool:
                nonlocal is_done
                recorder = processes.get('record')
                for name, process in processes.items():
                    if process.poll() == 2:
                        raise InputError(self._last_line(name))
                    # The recorder ends by itself, perhaps before the last turns, however long over, are watched.
                    ended_well = process is recorder and process.poll() == 0
                    if process.poll() is not None and not ended_well:
                        raise EpisodeError(f'{name} ended with status {process.returncode}: {self._last_line(name)}')
                if observer.machine.failure is not None:
                    raise observer.machine.failure
                is_done = observer.machine.done
                return is_done and (recorder is None or recorder.poll() == 0)

            spinner.spin(is_over)
        if interrupted.is_set():
            raise KeyboardInterrupt
        if not is_done:
            raise EpisodeError('interrupted before the end of the episode')

    def _maker(self, name: str) -> Callable[[], QuestionerNode]:
        overrides = [Parameter(key, value=value) for key, value in self.parameters[name].items()]
        return lambda: NODES[name](namespace=self.namespace, parameter_overrides=overrides)

    @contextlib.contextmanager
    def _processes(self, names: Iterable[str]) -> Iterator[dict[str, subprocess.Popen[bytes]]]:
        """Run a process for each of these nodes, in its own session so that a signal reaches all that it started."""
        processes = {}
        make_folder(self.log_dir)
        try:
            for name in names:
                with self._log(name).open('wb') as log:
                    processes[name] = subprocess.Popen(
                        self._command(name),
                        stdin=subprocess.DEVNULL,
                        stdout=log,
                        stderr=subprocess.STDOUT,
                        start_new_session=True,
                    )
            yield processes
        finally:
            stop(processes.values())

    def _command(self, name: str) -> list[str]:
        command = [sys.executable, '-m', 'al_questioner', name, '--ros-args', '-r', f'__ns:=/{self.namespace}']
        for key, value in self._parameters(name).items():
            command += ['-p', f'{key}:={json.dumps(value)}']
        return command

    def _parameters(self, name: str) -> Mapping[str, Value]:
        if self.bag is None:
            return self.parameters[name]
        if name == 'record':
            return {'bag': str(self.bag), 'namespace_in_bag': self.namespace_in_bag, 'until_done': True}
        return {**self.parameters[name], 'wait_for_recorder': True}

    def _log(self, name: str) -> Path:
        return self.log_dir / f'{name}.log'

    def _last_line(self, name: str) -> str:
        lines = self._log(name).read_text(errors='replace').strip().splitlines()
        return lines[-1] if lines else 'it printed nothing'


def stop(processes: Iterable[subprocess.Popen[bytes]]) -> None:
    """End processes by SIGINT, and by SIGKILL those that have not ended in time."""
    running = [process for process in processes if process.poll() is None]
    for process in running:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGINT)
    for process in running:
        try:
            process.wait(SECONDS_TO_STOP)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
