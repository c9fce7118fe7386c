"""From the arguments of a process to nodes that spin until they are asked to stop."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Sequence
from typing import Any

import rclpy
from rclpy.exceptions import NameValidationException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.utilities import remove_ros_args, try_shutdown

from al_questioner.domain import InputError
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.node_arguments import check_ros_arguments
from al_questioner.ros.parameter_files import refuse_files_without_parameters, tell_what_has_no_effect, with_doubts

TRANSPORTS = ('FASTDDS_BUILTIN_TRANSPORTS', 'UDPv4')
"""Environment variable and our value: a process that is killed may leave a lock of Fast DDS's shared memory behind, on
which all others hang for ever. Whoever sets the variable decides."""
ONCE_A_SECOND = {'throttle_duration_sec': 1.0}


def spin_nodes(
    makers: Sequence[Callable[[], QuestionerNode]],
    arguments: Sequence[str],
    while_spinning: Callable[[], Any] | None = None,
    interrupted: threading.Event | None = None,
) -> int:
    """Spin nodes in one process until SIGINT, SIGTERM or a shutdown of the context; return the exit status.

    Args:
        makers: make the nodes, once ROS is initialised.
        arguments: of the process, ROS arguments included.
        while_spinning: called after every wait; a true result ends the spinning.
        interrupted: set by SIGINT.

    Raises:
        InputError: a parameter that cannot be used.
    """
    check_ros_arguments(arguments)
    # Only rclpy's own handler, which shuts the context down, is to act on a signal: a KeyboardInterrupt could hit
    # anywhere, and the second SIGINT of `ros2 launch` would hit the clean-up.
    interrupted = interrupted or threading.Event()
    previous = signal.signal(signal.SIGINT, _setter(interrupted))
    try:
        os.environ.setdefault(*TRANSPORTS)
        # For its error: rclpy.init would print lines of its own beside it.
        remove_ros_args(['', *arguments])
        rclpy.init(args=list(arguments))
    except (RuntimeError, ValueError) as error:
        signal.signal(signal.SIGINT, previous)
        raise InputError(with_doubts(f'unusable ROS arguments: {_one_line(error)}', arguments)) from error
    nodes: list[QuestionerNode] = []
    executor = SingleThreadedExecutor()
    try:
        if interrupted.is_set():
            # Before rclpy had a handler of its own.
            raise ExternalShutdownException
        refuse_files_without_parameters(arguments)
        for make in makers:
            try:
                nodes.append(make())
            except InputError as error:
                raise InputError(with_doubts(str(error), arguments)) from error
            executor.add_node(nodes[-1])
            tell_what_has_no_effect(nodes[-1], arguments)
            if while_spinning is None:
                nodes[-1].get_logger().info('is up')
        while executor.context.ok() and not (while_spinning and while_spinning()):
            try:
                executor.spin_once(timeout_sec=0.1 if while_spinning else None)
            except ValueError as error:
                # rclpy's own callbacks, such as that of /clock, do not catch what a message makes them raise.
                nodes[0].get_logger().warning(f'passed over an unusable message: {_one_line(error)}', **ONCE_A_SECOND)
    except ExternalShutdownException:
        pass
    except RuntimeError:
        # The signal may come between the look at the context and its use.
        if executor.context.ok():
            raise
    except NameValidationException as error:
        raise InputError(_one_line(error)) from error
    finally:
        for node in nodes:
            node.destroy_node()
        executor.shutdown()
        try_shutdown()
        # Python gives a handler of ours back to the system as it exits, where a late SIGINT would kill; not so SIG_IGN.
        signal.signal(signal.SIGINT, signal.SIG_IGN if while_spinning is None else previous)
    return 0


def _setter(event: threading.Event) -> Callable[..., None]:
    return lambda *_: event.set()


def _one_line(error: Exception) -> str:
    return ' '.join(str(error).split())
