"""The base of all nodes: a worker thread, counted rejections, and diagnostics."""

from __future__ import annotations

import math
import re
import time
import traceback
from collections import Counter
from collections.abc import Callable, Collection, Mapping
from copy import copy
from typing import Any

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import SetParametersResult
from rclpy.clock import Clock
from rclpy.clock_type import ClockType
from rclpy.event_handler import PublisherEventCallbacks
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile

from al_questioner.domain import EpisodeError, InputError
from al_questioner.protocol.topics import TOPICS
from al_questioner.ros import qos
from al_questioner.ros.flexible_subscription import FlexibleSubscription, full_name, unserved
from al_questioner.ros.overrides import check_overrides, overriding_options
from al_questioner.ros.worker import Cancel, Worker
from al_questioner.support.rate_limiter import RepeatLimiter
from al_questioner.support.text import number_of

DIAGNOSTICS_PERIOD = 1.0
"""Seconds between two messages on /diagnostics."""
LOOK_PERIOD = 0.2
"""Seconds from one look for new publishers to the next."""
MAXIMAL_WAITING = 1000
"""Messages of a topic that is not latched."""

NO_WARNINGS = PublisherEventCallbacks(use_default_callbacks=False)
"""A warning that names the subscribers that a publisher does not suit comes once a second: see `unserved`."""

SECONDS_FOR_PUBLISHER = 10.0
"""Seconds without a publisher of what the node waits for, after which it warns."""

RECORDER = 'recorder'
"""Name of the node that records."""
SECONDS_FOR_RECORDER = 10.0
"""Seconds without a recorder, after which a node that waits for one warns."""

REJECTIONS_PER_SECOND = 10
"""Refusals that are logged each second, one for each reason. The rest is counted."""
DETAIL = re.compile(r"""'[^']*'|"[^"]*"|\S*[\d_]\S*|\b(nan|inf)\b""")
"""Names and numbers, by which refusals for one reason differ."""
REJECTION_SHOWN = 60.0
"""Seconds for which a refusal makes the node's status a warning; its count stays."""


class _LeavesOnError(type):
    """Type of nodes that leave the graph if their constructor refuses its input: their timers keep them alive."""

    def __call__(cls: Any, *arguments: Any, **node_arguments: Any) -> Any:
        node = object.__new__(cls)
        try:
            node.__init__(*arguments, **node_arguments)
        except InputError:
            QuestionerNode.destroy_node(node)
            raise
        return node


class QuestionerNode(Node, metaclass=_LeavesOnError):
    """A node whose callbacks only hand messages to its worker.

    Input that cannot be used is refused: counted, logged, and shown on /diagnostics; the node goes on.

    Args:
        name: of the node.
        topics: whose quality of service parameters may override, of this node or of its neighbours.
        node_arguments: of rclpy's node.

    Raises:
        InputError: an unusable parameter `qos_overrides`.
    """

    def __init__(self, name: str, topics: Collection[str] = TOPICS, **node_arguments: Any) -> None:
        super().__init__(name, **node_arguments)
        self._worker = Worker(name, self._failed)
        check_overrides(self, topics)
        self._advertised: list[str] = []
        self._hearings: list[FlexibleSubscription] = []
        self._rejected: Counter[str] = Counter()
        self._last_rejection = ''
        self._rejected_at = -math.inf
        self._said = RepeatLimiter(REJECTIONS_PER_SECOND, 1.0)
        self._failure = ''
        self._has_left = False
        self._activity = 'starting'
        self._awaited = ''
        self._began = time.monotonic()
        self._overdue = math.inf
        self._said_overdue = False
        self._last_warnings: list[str] = []
        self._diagnostics = self.advertise(DiagnosticArray, '/diagnostics', qos.DIAGNOSTICS)
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self.create_timer(DIAGNOSTICS_PERIOD, self._publish_diagnostics, clock=steady)
        self.create_timer(LOOK_PERIOD, self._look_for_publishers, clock=steady)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set all of the parameters, or none, as `ros2 param set` asks for; rclpy's own refusals say less."""
        unknown = [one.name for one in parameter_list if not self.has_parameter(one.name)]
        if unknown:
            known = ', '.join(self.get_parameters_by_prefix(''))
            return _rejection(f'no parameter {", ".join(unknown)}; known: {known}')
        fixed = [one.name for one in parameter_list if self.describe_parameter(one.name).read_only]
        if fixed:
            return _rejection(f'{", ".join(fixed)}: only read when the node starts: -p NAME:=VALUE')
        return super().set_parameters_atomically(parameter_list)

    def advertise(self, message_type: type, topic: str, profile: QoSProfile) -> Publisher:
        """Make a publisher whose quality of service parameters may override."""
        self._advertised.append(self.resolve_topic_name(topic))
        return self.create_publisher(
            message_type,
            topic,
            # What rclpy makes of the parameters is written into the profile.
            copy(profile),
            event_callbacks=NO_WARNINGS,
            qos_overriding_options=overriding_options(),
        )

    def listen(
        self, message_type: type, topic: str, hear: Callable[[Any], None], profile: QoSProfile, raw: bool = False
    ) -> None:
        """Have the executor's thread call a function with every message of a topic: see `FlexibleSubscription`."""
        self._hearings.append(FlexibleSubscription(self, message_type, topic, hear, profile, raw))

    def submit(self, job: Callable[[], None]) -> None:
        """Have the worker do a job."""
        self._worker.submit(job)

    def on_message(self, message_type: type, topic: str, job: Callable[[Any], None], profile: QoSProfile) -> None:
        """Have the messages of a topic handled by the worker; an InputError of the job is a refusal.

        Of a latched topic the newest counts: it takes the place of one that still waits for the worker. Of others the
        oldest that wait are dropped when there are too many.
        """

        def handle(message: Any) -> None:
            try:
                job(message)
            except InputError as error:
                self.reject(topic, str(error))

        is_latched = profile.durability == DurabilityPolicy.TRANSIENT_LOCAL
        self.listen(message_type, topic, self._worker.inbox(handle, 1 if is_latched else MAXIMAL_WAITING), profile)

    def after(self, seconds: float, job: Callable[[], None]) -> Cancel:
        """Have the worker do a job once, after these seconds of the steady clock.

        Returns:
            A function that calls the job off.
        """
        return self._worker.submit(job, seconds)

    def reject(self, topic: str, reason: str) -> None:
        """Count and show input that cannot be used."""
        self._rejected[topic] += 1
        self._last_rejection = f'{topic}: {reason}'
        self._rejected_at = time.monotonic()
        if self._said.passes(f'{topic}: {DETAIL.sub("", reason)}', self._rejected_at):
            more = self._said.held_back()
            others = f' ({number_of(more, "other refusal was", "other refusals were")} only counted)' if more else ''
            self.get_logger().warning(f'refused on {topic}: {reason}{others}')

    def set_status(self, activity: str, expected_within: float = math.inf, awaited: str = '') -> None:
        """Say in a few words what the node is doing, for /diagnostics; warn there if that lasts longer (seconds).

        Warn soon if it waits for a topic, `awaited`, on which nobody publishes.
        """
        self._activity = activity
        self._awaited = awaited
        self._began = time.monotonic()
        self._overdue = self._began + expected_within
        self._said_overdue = False

    def await_recorder(self, *topics: str) -> None:
        """Let nothing happen before a recorder listens to these topics: what is not latched would be lost to it.

        It is the worker that waits, with what arrives meanwhile queued behind.
        """

        def wait() -> None:
            self.set_status('waiting for a recorder', expected_within=SECONDS_FOR_RECORDER)
            while (
                self.context.ok() and not self._worker.stopped and not all(self._is_recorded(topic) for topic in topics)
            ):
                time.sleep(0.05)
            self.set_status('a recorder listens')

        self.submit(wait)

    def _is_recorded(self, topic: str) -> bool:
        listeners = self.get_subscriptions_info_by_topic(self.resolve_topic_name(topic))
        return any(listener.node_name == RECORDER for listener in listeners)

    def other_publishers(self, topic: str) -> list[str]:
        """Full names of the nodes that publish on a topic besides this one, which publishes there too.

        One that has only just appeared may be called 'another node'.
        """
        found = self.get_publishers_info_by_topic(self.resolve_topic_name(topic))
        names = [full_name(one) for one in found]
        if self.get_fully_qualified_name() in names:
            # Once: another node may have the same name.
            names.remove(self.get_fully_qualified_name())
        return names

    def health_warning(self) -> str:
        """Return a warning for /diagnostics about what surrounds the node and needs attention; empty if there is none.

        It is asked by the executor's thread once a second.
        """
        return ''

    def counts(self) -> Mapping[str, int]:
        """Return the counters of the node, for /diagnostics."""
        return {f'refused on {topic}': count for topic, count in dict(self._rejected).items()}

    def measurements(self) -> Mapping[str, str]:
        """Return the measurements of the node, in words, for /diagnostics."""
        return {}

    def destroy_node(self) -> None:
        """Stop the worker, then leave the graph."""
        self._worker.stop()
        self._has_left = True
        super().destroy_node()

    def _failed(self, error: Exception) -> None:
        # A job that outlasts the node finds nothing left to publish on.
        if self._has_left or not self.context.ok():
            return
        is_foreseen = isinstance(error, (InputError, EpisodeError))
        failure = str(error) if is_foreseen else f'{type(error).__name__}: {error}'
        # What fails may be tried again with every message.
        if failure != self._failure:
            self._failure = failure
            self.get_logger().error(failure if is_foreseen else ''.join(traceback.format_exception(error)))

    def _look_for_publishers(self) -> None:
        for hearing in self._hearings:
            hearing.look()

    def _mismatches(self) -> list[str]:
        """Return a line for each publisher or subscriber whose quality of service does not fit."""
        unheard = [line for hearing in self._hearings for line in hearing.unheard()]
        return unheard + [line for topic in self._advertised for line in unserved(self, topic)]

    def _late(self) -> str:
        """Return the activity that has taken too long, and who publishes what it waits for; else an empty text."""
        activity, awaited, now = self._activity, self._awaited, time.monotonic()
        publishers = self.other_publishers(awaited) if awaited else []
        if now <= self._overdue and (not awaited or publishers or now <= self._began + SECONDS_FOR_PUBLISHER):
            return ''
        late = f'{activity} for too long'
        if not awaited:
            return late
        topic = self.resolve_topic_name(awaited)
        by = ', '.join(dict.fromkeys(publishers))
        return f'{late}: {f"{topic} is published by {by}" if by else f"nobody publishes {topic}"}'

    def _publish_diagnostics(self) -> None:
        overdue = self._late()
        if overdue and not self._said_overdue:
            self._said_overdue = True
            self.get_logger().warning(f'{overdue}: is everything running that should be?')
        warnings = [*filter(None, [self.health_warning()]), *self._mismatches()]
        for warning in warnings:
            if warning not in self._last_warnings:
                self.get_logger().warning(warning)
        self._last_warnings = warnings
        is_refusal_shown = time.monotonic() - self._rejected_at < REJECTION_SHOWN
        refused = [f'refused {self._last_rejection}'] if is_refusal_shown else []
        level = DiagnosticStatus.WARN if overdue or warnings or refused else DiagnosticStatus.OK
        message = '; '.join([overdue or self._activity, *refused, *warnings])
        if self._failure:
            level, message = DiagnosticStatus.ERROR, self._failure
        status = DiagnosticStatus(
            level=level,
            name=self.get_fully_qualified_name().lstrip('/'),
            message=message,
            hardware_id='al_questioner',
            values=[
                KeyValue(key=what, value=str(count)) for what, count in {**self.counts(), **self.measurements()}.items()
            ],
        )
        array = DiagnosticArray(status=[status])
        array.header.stamp = self.get_clock().now().to_msg()
        self._diagnostics.publish(array)


def _rejection(reason: str) -> SetParametersResult:
    return SetParametersResult(successful=False, reason=reason)
