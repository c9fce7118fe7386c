"""Running of nodes in a process, from its arguments until it is asked to stop."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.utilities import remove_ros_args, try_shutdown

from al_questioner.domain import InputError
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.node_arguments import check_ros_arguments
from al_questioner.ros.parameter_files import reject_files_without_parameters, tell_what_has_no_effect, with_doubts

TRANSPORTS = ('FASTDDS_BUILTIN_TRANSPORTS', 'UDPv4')
"""Environment variable for the transports of Fast DDS, and our value.

With shared memory, a killed process may leave a lock behind on which all others wait without end. A value that the
user has set is kept.
"""
SomeNode = TypeVar('SomeNode', bound=QuestionerNode)
ONCE_A_SECOND = {'throttle_duration_sec': 1.0}


class Spinner:
    """Context manager that spins nodes; SIGINT, SIGTERM and a shutdown of the context end its block without an error.

    Args:
        arguments: arguments of the process, including ROS arguments.
        interrupted: set by SIGINT.
        ends_process: whether the process ends afterwards.

    Raises:
        InputError: on entry, arguments that cannot be used.
    """

    def __init__(
        self, arguments: Sequence[str], interrupted: threading.Event | None = None, ends_process: bool = False
    ) -> None:
        self._arguments = arguments
        self._interrupted = interrupted or threading.Event()
        self._ends_process = ends_process
        self._nodes: list[QuestionerNode] = []

    def __enter__(self) -> Spinner:
        check_ros_arguments(self._arguments)
        # Only rclpy's own handler, which shuts the context down, may act on a signal: a KeyboardInterrupt could come
        # anywhere, and the second SIGINT of `ros2 launch` would interrupt the clean-up.
        self._previous = signal.signal(signal.SIGINT, lambda *_: self._interrupted.set())
        try:
            os.environ.setdefault(*TRANSPORTS)
            # Called for its error: rclpy.init would print lines of its own as well.
            remove_ros_args(['', *self._arguments])
            rclpy.init(args=list(self._arguments))
        except (RuntimeError, ValueError) as error:
            signal.signal(signal.SIGINT, self._previous)
            text = f'unusable ROS arguments: {_one_line(error)}'
            raise InputError(with_doubts(text, self._arguments)) from error
        self._executor = SingleThreadedExecutor()
        return self

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        # A signal may come between the check of the context and its use.
        is_asked_to_stop = isinstance(error, ExternalShutdownException) or (
            isinstance(error, RuntimeError) and not self._executor.context.ok()
        )
        for node in self._nodes:
            node.destroy_node()
        self._executor.shutdown()
        try_shutdown()
        # At exit Python removes a handler of ours, and a late SIGINT would kill the process; SIG_IGN stays.
        signal.signal(signal.SIGINT, signal.SIG_IGN if self._ends_process else self._previous)
        return is_asked_to_stop

    def add(self, make: Callable[[], SomeNode]) -> SomeNode:
        """Make a node that is spun with the others.

        Raises:
            InputError: a parameter that cannot be used.
        """
        if self._interrupted.is_set():
            # The signal came before rclpy had a handler of its own.
            raise ExternalShutdownException
        reject_files_without_parameters(self._arguments)
        try:
            node = make()
        except InputError as error:
            raise InputError(with_doubts(str(error), self._arguments)) from error
        except NameValidationException as error:
            raise InputError(_one_line(error)) from error
        self._nodes.append(node)
        self._executor.add_node(node)
        tell_what_has_no_effect(node, self._arguments)
        return node

    def spin(self, is_over: Callable[[], Any] | None = None) -> None:
        """Spin until the context is shut down or `is_over` returns true, which is checked after every wait."""
        while self._executor.context.ok() and not (is_over and is_over()):
            try:
                self._executor.spin_once(timeout_sec=0.1 if is_over else None)
            except ValueError as error:
                # rclpy's own callbacks, such as that of /clock, do not catch the errors that a message causes.
                text = f'ignored an unusable message: {_one_line(error)}'
                self._nodes[0].get_logger().warning(text, **ONCE_A_SECOND)


def spin_node(make: Callable[[], SomeNode], arguments: Sequence[str]) -> SomeNode | None:
    """Run a process with one node, until it is asked to stop.

    Returns:
        The node, destroyed by then; None if the signal came before it was made.

    Raises:
        InputError: an argument or a parameter that cannot be used.
    """
    node = None
    with Spinner(arguments, ends_process=True) as spinner:
        node = spinner.add(make)
        node.get_logger().info('is up')
        spinner.spin()
    return node


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())
