"""The episode through three ROS processes, and every message that they send."""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from measuring import Seconds
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from std_msgs.msg import String
from turn_parts.topics import IF_ASKED, SPOKEN, TYPES, VOLATILE

from al_questioner.domain import EpisodeError, QueryRecord
from al_questioner.messages import documents
from al_questioner.messages.stamps import SECOND, stamp_of
from al_questioner.ros import qos
from al_questioner.ros.episode_launcher import EpisodeLauncher
from al_questioner.ros.node import RECORDER

MESSAGES_A_TURN, REPEATS = 2, 100
"""Of a topic, at most."""
SECONDS_TO_HEAR = 60.0
"""After the end of an episode, far more than it takes."""


@contextlib.contextmanager
def spinning(context: Context) -> Iterator[SingleThreadedExecutor]:
    """An executor in a thread, in a new context; what was added to it is destroyed in the end."""
    context.init()
    executor = SingleThreadedExecutor(context=context)

    def spin() -> None:
        with contextlib.suppress(ExternalShutdownException):
            executor.spin()

    thread = threading.Thread(target=spin, daemon=True)
    thread.start()
    try:
        yield executor
    finally:
        nodes = executor.get_nodes()
        executor.shutdown()
        thread.join(5.0)
        for node in nodes:
            node.destroy_node()
        context.try_shutdown()


@contextlib.contextmanager
def recorder(namespace: str) -> Iterator[dict[str, list[bytes]]]:
    """The serialised messages of each topic, unopened, so that listening takes the graph little time.

    The node has the name of the one that others wait for with `wait_for_recorder`.
    """
    heard: dict[str, list[bytes]] = {topic: [] for topic in TYPES}
    with spinning(context := Context()) as executor:
        node = Node(RECORDER, namespace=namespace, context=context)
        executor.add_node(node)
        for topic, message_type in TYPES.items():
            durability = DurabilityPolicy.VOLATILE if topic in VOLATILE else DurabilityPolicy.TRANSIENT_LOCAL
            profile = QoSProfile(depth=1000, reliability=ReliabilityPolicy.RELIABLE, durability=durability)
            node.create_subscription(message_type, topic, heard[topic].append, profile, raw=True)
        # It is waited for, but no part of a turn.
        node.create_subscription(String, 'episode', lambda _: None, qos.LATCHED)
        executor.wake()
        yield heard


@dataclass(frozen=True, eq=False)
class GraphEpisode:
    """An episode that three processes played.

    Attributes:
        starting: seconds from the start of the processes to the end of the learner's first turn.
        walls: seconds from the start of a turn to that of the next, by turn (1-based), as the learner stamps them; not
            of the last.
        waiting: seconds a turn that the threads of the three processes waited for a core, all together; NaN where the
            system does not tell.
        whole: seconds from the start of the processes to the last state of the learner.
        records: the queries, in order.
        heard: the serialised messages of each topic.
    """

    starting: float
    walls: Mapping[int, float]
    waiting: float
    whole: float
    records: tuple[QueryRecord, ...]
    heard: Mapping[str, list[bytes]]

    def settled_walls(self) -> tuple[list[int], Seconds]:
        """The turns after the first, which waits for discovery, and their seconds."""
        turns = [turn for turn in sorted(self.walls) if turn > 1]
        return turns, np.array([self.walls[turn] for turn in turns])


def play_graph(
    namespace: str, parameters: Mapping[str, Mapping[str, Any]], log_dir: Path, patience: float
) -> GraphEpisode:
    """Play an episode through three processes, see `EpisodeLauncher`.

    Raises:
        InputError, EpisodeError: as `EpisodeLauncher.play`.
    """
    last: tuple[float, tuple[QueryRecord, ...]] = (0.0, ())
    waited: dict[int, float] = {}
    turns = parameters['learner']['turns']
    whole = {name: {**own, **nothing_lost(name, namespace, turns)} for name, own in parameters.items()}

    def watch(turn: int, records: tuple[QueryRecord, ...]) -> None:
        nonlocal last
        last = time.perf_counter(), records
        if turn == turns or not waited:
            waited[turn] = children_waited()
        if turn == turns:
            # While the processes live: what they have latched goes with them.
            await_all(heard, [topic for topic in TYPES if records or topic not in IF_ASKED])

    with recorder(namespace) as heard:
        begun, start = time.time(), time.perf_counter()
        EpisodeLauncher(
            namespace=namespace,
            episode_id=str(parameters['learner']['episode_id']),
            parameters=whole,
            one_process=False,
            log_dir=log_dir,
            patience=patience,
        ).play(watch)
    begins = turn_begins(documents.read('turn', text.data) for text in opened(heard, 'turn'))
    walls = {turn: begins[turn + 1] - begin for turn, begin in begins.items() if turn + 1 in begins}
    starting = begins[2] - begun
    waiting = (max(waited.values()) - min(waited.values())) / max(1, turns - min(waited))
    return GraphEpisode(starting, walls, waiting, last[0] - start, last[1], heard)


def nothing_lost(name: str, namespace: str, turns: int) -> dict[str, Any]:
    """Parameters of a node with which each of its messages is heard, however short the episode and busy the machine.

    It waits for the recorder, and no message takes the place of one that has not arrived.
    """
    depth = MESSAGES_A_TURN * turns + REPEATS
    topics = (f'/{namespace}/{topic}' for topic in SPOKEN[name])
    return {'wait_for_recorder': True, **{f'qos_overrides.{topic}.publisher.depth': depth for topic in topics}}


def await_all(heard: Mapping[str, Sequence[bytes]], topics: Sequence[str]) -> None:
    """Wait until a message of each of these topics has been heard.

    Raises:
        EpisodeError: one was not.
    """
    end = time.monotonic() + SECONDS_TO_HEAR
    while missing := [topic for topic in topics if not heard[topic]]:
        if time.monotonic() > end:
            raise EpisodeError(f'nothing was heard on {", ".join(missing)}')
        time.sleep(0.01)


def children_waited() -> float:
    """Seconds that the living threads of the child processes have been ready to run without a core; NaN if unknown."""
    known = []
    for children in Path('/proc/self/task').glob('*/children'):
        for pid in children.read_text().split():
            for statistics in Path(f'/proc/{pid}/task').glob('*/schedstat'):
                with contextlib.suppress(OSError):  # a thread may just have ended
                    known.append(int(statistics.read_text().split()[1]) / SECOND)
    return sum(known) if known else float('nan')


def opened(heard: Mapping[str, list[bytes]], topic: str) -> list[Any]:
    """The messages of a topic."""
    return [deserialize_message(octets, TYPES[topic]) for octets in heard[topic]]


def turn_begins(turns: Iterator[documents.Document]) -> dict[int, float]:
    """Seconds since the epoch at which the learner began each turn, from its `turn` documents."""
    return {document['turn']: stamp_of(document['stamp']) / SECOND for document in turns}
