"""Cost of durability: the time from an answer to its acknowledgement, with and without a session log.

    python benchmarks/session.py [--answers N] [--repeats R] [--folder DIR]

A learner and the simulated perception in this process, and a client that answers every query over the topics as soon
as it comes. A row holds median and 99th percentile over all answers: without a log; with one that does not wait for
the disk (synchronous=OFF); and with one that does (synchronous=FULL), which is how the learner works. Then the same for
the log alone: one append of an answer, and of a scene with its decision. The kinds of log take turns, R times, so that
a busy machine treats them alike. --folder says on which disk.
"""

from __future__ import annotations

import argparse
import itertools
import json
import os
import tempfile
import threading
import time
import uuid
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from measuring import print_table
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter
from std_msgs.msg import String
from turn_parts.recording import spinning

from al_questioner.domain import Answer, Outcome
from al_questioner.event_log.encoding import Encoder, decoded
from al_questioner.event_log.events import ActionChosen, AnswerAccepted, SceneObserved
from al_questioner.event_log.log import SessionLog, read_log
from al_questioner.event_log.storage import SqliteStorage, StorageFactory
from al_questioner.messages import documents
from al_questioner.ros import qos
from al_questioner.ros.nodes.learner import LearnerNode
from al_questioner.ros.nodes.perception import PerceptionNode


class UnwaitedStorage(SqliteStorage):
    """Does not wait for the disk."""

    def __init__(self, folder: Path, head: bytes) -> None:
        super().__init__(folder, head)
        self._database.execute('PRAGMA synchronous=OFF')


KINDS: dict[str, StorageFactory | None] = {
    'no log': None,
    'synchronous OFF': UnwaitedStorage,
    'synchronous FULL': SqliteStorage,
}
DEADLINE = 600.0


class Client(Node):
    """Skips every question, and measures how long it takes until that is acknowledged."""

    def __init__(self, answers: int, **node_arguments: Any) -> None:
        super().__init__('client', **node_arguments)
        self.seconds: list[float] = []
        self.done = threading.Event()
        self._answers = answers
        self._sent = 0.0
        self._publisher = self.create_publisher(String, 'answer', qos.EVENTS)
        self.create_subscription(String, 'query', self._answer, qos.LATCHED)
        self.create_subscription(String, 'answer_ack', self._acknowledged, qos.EVENTS)

    def _answer(self, message: String) -> None:
        query = json.loads(message.data)
        answer = Answer(query['query_id'], 'a1', 'client', Outcome.SKIP)
        self._sent = time.perf_counter()
        text = documents.write('answer', query['episode_id'], documents.answer_members(answer))
        self._publisher.publish(String(data=text))

    def _acknowledged(self, message: String) -> None:
        self.seconds.append(time.perf_counter() - self._sent)
        if len(self.seconds) == self._answers:
            self.done.set()


def over_topics(kind: str, answers: int, folder: Path) -> list[float]:
    """Seconds from each answer to its acknowledgement."""
    storage = KINDS[kind]
    context, namespace = Context(), f'bench_{uuid.uuid4().hex[:8]}'
    world = {'task': 'kitchen_table', 'seed': 1}
    episode = {**world, 'strategy': 'u_sampling', 'budget': float(answers), 'turns': answers}

    def made(node: Callable[..., Node], **parameters: Any) -> Node:
        overrides = [Parameter(name, value=value) for name, value in parameters.items()]
        return node(namespace=namespace, context=context, parameter_overrides=overrides)

    with spinning(context) as executor:
        client = Client(answers, namespace=namespace, context=context)
        learner = partial(LearnerNode, storage=storage or SqliteStorage)
        session = str(folder) if storage else ''
        for node in (client, made(PerceptionNode, **world), made(learner, **episode, session=session)):
            executor.add_node(node)
        if not client.done.wait(DEADLINE):
            raise SystemExit(f'only {len(client.seconds)} of {answers} answers were acknowledged')
    return client.seconds


def appends(kind: str, events: list[Any], folder: Path) -> tuple[list[float], list[float]]:
    """Seconds that writing each answer, and each scene with its decision, takes."""
    storage = KINDS[kind]
    if storage is None:
        return [], []
    encoder, answers, turns = Encoder(), [], []
    with SessionLog(folder, storage) as log:
        for first, second in itertools.pairwise(events):
            start = time.perf_counter()
            if isinstance(first, SceneObserved) and isinstance(second, ActionChosen):
                log.append(encoder.encode(first), encoder.encode(second))
                turns.append(time.perf_counter() - start)
            elif isinstance(first, AnswerAccepted):
                log.append(encoder.encode(first))
                answers.append(time.perf_counter() - start)
    return answers, turns


def cells(seconds: list[float]) -> list[str]:
    """Median and 99th percentile in milliseconds."""
    if not seconds:
        return ['', '']
    return [f'{1000 * value:.2f}' for value in np.percentile(seconds, (50, 99))]


def main() -> None:
    """Print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--answers', type=int, default=200, help='an episode (%(default)s)')
    parser.add_argument('--repeats', type=int, default=3, help='episodes of each kind (%(default)s)')
    parser.add_argument('--folder', type=Path, default=Path('out'), help='where the logs are written (%(default)s)')
    given = parser.parse_args()
    os.environ.setdefault('ROS_AUTOMATIC_DISCOVERY_RANGE', 'LOCALHOST')
    given.folder.mkdir(parents=True, exist_ok=True)
    columns: dict[str, tuple[list[float], list[float], list[float]]] = {kind: ([], [], []) for kind in KINDS}
    with tempfile.TemporaryDirectory(dir=given.folder) as folder:
        for repeat in range(given.repeats):
            for kind in KINDS:
                columns[kind][0].extend(over_topics(kind, given.answers, Path(folder) / f'{repeat} {kind}'))
            events, _ = decoded(read_log(Path(folder) / f'{repeat} synchronous FULL'))
            for kind in KINDS:
                answers, turns = appends(kind, events, Path(folder) / f'{repeat} {kind} alone')
                columns[kind][1].extend(answers)
                columns[kind][2].extend(turns)
    print_table(
        f'{given.repeats} x {given.answers} answers, milliseconds',
        ('', 'answer to ack', '99 %', 'append answer', '99 %', 'append scene', '99 %'),
        [[kind, *(cell for seconds in columns[kind] for cell in cells(seconds))] for kind in KINDS],
    )


if __name__ == '__main__':
    main()
