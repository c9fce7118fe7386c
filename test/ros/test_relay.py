"""Topics over a bad line: messages are lost, doubled, late, and overtake each other."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import String

from al_questioner.event_log.encoding import decoded
from al_questioner.event_log.events import AnswerAccepted
from al_questioner.event_log.log import read_log
from al_questioner.protocol.retransmitter import BackOff
from al_questioner.ros import qos
from al_questioner.ros.node import QuestionerNode
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode
from al_questioner.ros.nodes.teacher import TeacherNode
from shared.offline import offline_queries

SHARE = 0.2
"""Of the messages, for each of the four things that can happen to one."""
LONGEST_DELAY = 0.1
"""Seconds: several of the pauses after which things are said again here."""
QUICK = BackOff(first=0.02, longest=0.08)


class Line(NamedTuple):
    """A topic that leads from the namespace of one node to those of others."""

    topic: str
    speaker: str
    listeners: tuple[str, ...]
    message_type: type = String
    profile: QoSProfile = qos.LATCHED


LINES = (
    Line('episode', 'learner', ('watcher',)),
    Line('turn', 'learner', ('perception',)),
    Line('objects', 'perception', ('learner',), PointCloud2),
    Line('query', 'learner', ('teacher',)),
    Line('answer', 'teacher', ('learner',), profile=qos.EVENTS),
    Line('answer_ack', 'learner', ('teacher',), profile=qos.EVENTS),
    Line('learner_state', 'learner', ('watcher',)),
)


class Relay(QuestionerNode):
    """Carries what is said on some lines, badly.

    Attributes:
        fates: how many messages met with what, by topic.
    """

    def __init__(self, lines: Sequence[Line], seed: int, **node_arguments: Any) -> None:
        super().__init__('relay', **node_arguments)
        self.fates = {line.topic: Counter[str]() for line in lines}
        self._rng = np.random.default_rng(seed)
        self._held: dict[Publisher, list[Any]] = {}
        for line in lines:
            for listener in line.listeners:
                out = self.create_publisher(line.message_type, f'{listener}/{line.topic}', line.profile)
                carry = partial(self._carry, self.fates[line.topic], out)
                self.on_message(line.message_type, f'{line.speaker}/{line.topic}', carry, line.profile)

    def _carry(self, fates: Counter[str], out: Publisher, message: Any) -> None:
        fates['all'] += 1
        if self._happens('dropped', fates):
            return
        for _ in range(1 + self._happens('doubled', fates)):
            if self._happens('delayed', fates):
                self.after(float(self._rng.uniform(0, LONGEST_DELAY)), partial(out.publish, message))
            elif self._happens('overtaken', fates):
                self._held.setdefault(out, []).append(message)
            else:
                for each in (message, *self._held.pop(out, ())):
                    out.publish(each)

    def _happens(self, fate: str, fates: Counter[str]) -> bool:
        happens = bool(self._rng.random() < SHARE)
        fates[fate] += happens
        return happens


@pytest.mark.parametrize('seed', [1, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(2, 12))])
def test_a_bad_line_changes_no_label(graph: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seed: int) -> None:
    """A lost question does not stall the robot, and a late answer is not taken for one to another question."""
    monkeypatch.setattr('al_questioner.protocol.learner.PATIENT', QUICK)
    monkeypatch.setattr('al_questioner.protocol.answer_sender.PERSISTENT', QUICK)
    rates = {'wrong_rate': 0.1, 'unknown_rate': 0.2}
    expected = offline_queries('u_sampling_fsq', 9.0, 10, seed=seed, teacher=rates)
    world = {'task': 'prepare_lunch', 'seed': seed}
    states = graph.listen('learner_state', topic='watcher/learner_state')
    relay = graph.start(lambda **arguments: Relay(LINES, seed, **arguments))
    graph.start(PerceptionNode, namespace=f'{graph.namespace}/perception', **world)
    graph.start(TeacherNode, namespace=f'{graph.namespace}/teacher', **world, **rates)
    graph.start(
        LearnerNode, namespace=f'{graph.namespace}/learner', **world, session=str(tmp_path / 'log'),
        strategy='u_sampling_fsq', budget=9.0, turns=10,
    )  # fmt: skip
    graph.wait_for(lambda: any(state['done'] for state in states), 'the end of the episode')
    assert next(state['queries'] for state in states if state['done']) == expected
    events, damage = decoded(read_log(tmp_path / 'log'))
    assert damage is None
    told = [event.answer.query_id for event in events if isinstance(event, AnswerAccepted)]
    assert told == [f'q{number}' for number in range(1, len(expected) + 1)]
    fates = sum(relay.fates.values(), Counter())
    # How many messages there are depends on how fast the machine is.
    assert min(fates[fate] for fate in ('dropped', 'doubled', 'delayed', 'overtaken')) > 0
