"""Clouds that a recogniser names in a second, the time from `objects` to `recognised`, and the time to load a file.

    python benchmarks/recognition_rate.py [--things 40] [--examples 200] [--symbols 8]
    python benchmarks/recognition_rate.py --offline    # without ROS: the first two tables

Things and examples are made up: each symbol, and none, is a cloud of points in the features. The first table is the
work on one cloud, part by part, on one core. The last one is of a recogniser in a process of its own, on one core, that
hears clouds as a camera sends them, at a rate, and then each as soon as the last one is recognised.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

# As the executables do; it must be said before numpy is imported.
os.environ.setdefault('OMP_NUM_THREADS', '1')

import numpy as np
from measuring import print_table

from al_questioner.domain import (
    DEFAULT_CLASSIFIERS,
    NO_SYMBOL,
    EpisodeError,
    InputError,
    Knowledge,
    Lesson,
    Origin,
    Scene,
    SeenView,
    ViewLabel,
)
from al_questioner.messages.concepts_file import read_concepts, write_concepts
from al_questioner.questioning import SceneRecogniser

GROUPS = ('colour', 'size', 'shape', 'texture', 'weight', 'location', 'base', 'arms', 'hands', 'noise')
FEATURES = tuple(f'{GROUPS[i % len(GROUPS)]}_{i}' for i in range(74))
"""As many as the simulated perception has."""
SECOND = 1_000_000_000
PATIENCE = 60.0
"""Seconds without an answer after which the recogniser is given up."""


def parser() -> argparse.ArgumentParser:
    """The arguments."""
    result = argparse.ArgumentParser(description=(__doc__ or '').splitlines()[0])
    result.add_argument('--things', type=int, default=40, help='in each cloud (%(default)s)')
    result.add_argument('--examples', type=int, default=200, help='that are known (%(default)s)')
    result.add_argument('--symbols', type=int, default=8, help='that are known (%(default)s)')
    result.add_argument('--clouds', type=int, default=900, help='of each measurement (%(default)s)')
    result.add_argument('--rate', type=float, default=30.0, help='of the camera, clouds a second (%(default)s)')
    result.add_argument('--seed', type=int, default=0, help='of the things (%(default)s)')
    result.add_argument('--offline', action='store_true', help='without ROS: the first two tables')
    return result


def made_up(given: argparse.Namespace) -> tuple[Knowledge, Scene]:
    """Knowledge of clusters, one lesson an example, and a scene of other things of them."""
    rng = np.random.default_rng(given.seed)
    symbols = tuple(f'symbol_{i}' for i in range(given.symbols))
    names = (*symbols, NO_SYMBOL)
    centres = rng.normal(scale=2.0, size=(len(names), len(FEATURES)))

    def looks(kinds: Any) -> Any:
        return (centres[kinds] + rng.normal(size=(len(kinds), len(FEATURES)))).astype(np.float32)

    kinds = np.arange(given.examples) % len(names)
    lessons = [
        Lesson(
            'day', number, None, (SeenView(number, number, tuple(look.tolist())),), labels=(ViewLabel(number, label),)
        )
        for number, (look, label) in enumerate(zip(looks(kinds), (names[kind] for kind in kinds), strict=True), start=1)
    ]
    knowledge = Knowledge(
        symbols, FEATURES, DEFAULT_CLASSIFIERS, lessons=tuple(lessons), origins=(Origin('day', symbols),)
    )
    places = rng.uniform(0, 1, size=(given.things, 3)).astype(np.float32)
    seen = looks(rng.integers(0, len(names), size=given.things))
    return knowledge, Scene(tuple(range(given.things)), places, seen, FEATURES)


def timed(job: Callable[[], Any], repeats: int = 1) -> float:
    """Milliseconds that a job takes, the mean of some repeats."""
    start = time.perf_counter()
    for _ in range(repeats):
        job()
    return 1000 * (time.perf_counter() - start) / repeats


def report_loading(knowledge: Knowledge, path: Path) -> None:
    """Print what it takes to begin with a file."""
    rows = [
        ['size, kB', f'{path.stat().st_size / 1000:.0f}'],
        ['read, ms', f'{timed(lambda: read_concepts(path)):.0f}'],
        ['learn, ms', f'{timed(lambda: SceneRecogniser().follow(knowledge)):.0f}'],
    ]
    print_table('Concepts file', ('', str(len(knowledge.examples)) + ' examples'), rows)


def report_work(knowledge: Knowledge, scene: Scene, repeats: int) -> None:
    """Print the work on one cloud; the encodings only where the message types are installed."""
    recogniser = SceneRecogniser()
    recogniser.follow(knowledge)
    parts: dict[str, Callable[[], Any]] = {'recognise': lambda: recogniser.look(scene)}
    try:
        parts |= encodings(recogniser.look(scene), scene)
    except ImportError as error:
        print(f'without the messages ({error})')
    for job in parts.values():
        job()
    spent = {name: timed(job, repeats) for name, job in parts.items()}
    rows = [[name, f'{each:.2f}'] for name, each in spent.items()]
    total = sum(spent.values())
    rows += [[], ['all', f'{total:.2f}'], ['clouds a second', f'{1000 / total:.0f}']]
    print_table('Work on one cloud', ('', 'ms'), rows)


def encodings(recognition: Any, scene: Scene) -> dict[str, Callable[[], Any]]:
    """Jobs that read a cloud, and write what was recognised in each of its forms."""
    from rclpy.serialization import deserialize_message, serialize_message
    from sensor_msgs.msg import PointCloud2

    from al_questioner.messages import documents
    from al_questioner.messages.clouds import cloud_of_scene, scene_of_cloud
    from al_questioner.messages.markers import recognised_markers
    from al_questioner.messages.recognition import cloud_of_recognition, recognition_members
    from al_questioner.ros.types import CLOUD_TYPES, MARKER_TYPES, header, text

    head = header(1, 'table')
    packed = serialize_message(cloud_of_scene(scene, head, CLOUD_TYPES))

    def document() -> str:
        return documents.write('recognition', 'day', recognition_members(recognition, 1, 'table'))

    return {
        'read objects': lambda: scene_of_cloud(deserialize_message(packed, PointCloud2)),
        'write recognised': lambda: serialize_message(cloud_of_recognition(recognition, head, CLOUD_TYPES)),
        'write recognition': lambda: serialize_message(text(document())),
        'write recognised_markers': lambda: serialize_message(recognised_markers(recognition, head, MARKER_TYPES)),
    }


@contextmanager
def recogniser_process(path: Path) -> Iterator[subprocess.Popen[bytes]]:
    """A recogniser with a file, on one core, until the block ends."""
    command = [sys.executable, '-m', 'al_questioner', 'recognise', '--ros-args', '-p', f'concepts:={path}']
    process = subprocess.Popen([*command, '--log-level', 'warn'], stdin=subprocess.DEVNULL)
    # Before it has threads, which take this over.
    os.sched_setaffinity(process.pid, {max(os.sched_getaffinity(0))})
    try:
        yield process
    finally:
        process.terminate()
        process.wait(10)


class Camera:
    """Sender of clouds that notes when each of them is recognised."""

    def __init__(self, scene: Scene) -> None:
        import rclpy
        from sensor_msgs.msg import PointCloud2

        from al_questioner.messages.clouds import cloud_of_scene
        from al_questioner.ros import qos
        from al_questioner.ros.types import CLOUD_TYPES, header

        self._spin_once = rclpy.spin_once
        self._node = rclpy.create_node('camera')
        self._cloud = cloud_of_scene(scene, header(0, 'table'), CLOUD_TYPES)
        self._eyes = self._node.create_publisher(PointCloud2, 'objects', qos.LATCHED)
        self._node.create_subscription(PointCloud2, 'recognised', self._hear, qos.EVENTS)
        self.sent: dict[int, float] = {}
        self.seconds: dict[int, float] = {}

    def send(self) -> int:
        """Send a cloud, and return its number."""
        number = len(self.sent) + 1
        self._cloud.header.stamp.sec = number
        self.sent[number] = time.perf_counter()
        self._eyes.publish(self._cloud)
        return number

    def spin(self, seconds: float) -> None:
        """Hear for some time, or until something was heard."""
        self._spin_once(self._node, timeout_sec=max(0.0, seconds))

    def await_recognition(self, number: int, process: subprocess.Popen[bytes]) -> None:
        """Hear until a cloud is recognised.

        Raises:
            EpisodeError: it never is.
        """
        end = time.perf_counter() + PATIENCE
        while number not in self.seconds:
            self.spin(0.1)
            if process.poll() is not None or time.perf_counter() > end:
                raise EpisodeError(f'cloud {number} was not recognised')

    def _hear(self, cloud: Any) -> None:
        number = cloud.header.stamp.sec
        self.seconds.setdefault(number, time.perf_counter() - self.sent[number])


def measure_graph(scene: Scene, path: Path, given: argparse.Namespace) -> None:
    """Print the times through ROS.

    Raises:
        EpisodeError: a cloud was not recognised.
    """
    import rclpy

    rclpy.init()
    try:
        with recogniser_process(path) as process:
            camera = Camera(scene)
            # The first is latched, and recognised as soon as the file is learnt.
            camera.await_recognition(camera.send(), process)
            start = time.perf_counter()
            numbers = []
            for i in range(given.clouds):
                while (wait := start + i / given.rate - time.perf_counter()) > 0:
                    camera.spin(wait)
                numbers.append(camera.send())
            camera.await_recognition(numbers[-1], process)
            at_rate = [camera.seconds[number] for number in numbers if number in camera.seconds]
            start = time.perf_counter()
            for _ in range(given.clouds):
                camera.await_recognition(camera.send(), process)
            each = (time.perf_counter() - start) / given.clouds
    finally:
        rclpy.try_shutdown()
    median, late = (1000 * float(each) for each in np.percentile(at_rate, (50, 99)))
    rows = [
        [f'recognised of {given.clouds} at {given.rate:g} a second', str(len(at_rate))],
        ['from objects to recognised, median, ms', f'{median:.1f}'],
        ['99 %, ms', f'{late:.1f}'],
        ['clouds a second, one after another', f'{1 / each:.0f}'],
    ]
    print_table('Through ROS, in two processes', ('', ''), rows)


def main() -> int:
    """Measure, and print the tables."""
    given = parser().parse_args()
    if min(given.things, given.examples, given.clouds) < 1 or given.symbols < 2 or given.rate <= 0:
        print('every number must be positive, and the symbols two or more', file=sys.stderr)
        return 2
    # Away from other graphs; before anything of ROS is imported.
    os.environ['ROS_DOMAIN_ID'] = str(1 + os.getpid() % 100)
    os.environ['ROS_AUTOMATIC_DISCOVERY_RANGE'] = 'LOCALHOST'
    print(f'{os.cpu_count()} cores; load average at the start: {os.getloadavg()[0]:.1f}\n')
    knowledge, scene = made_up(given)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / 'concepts.json'
        write_concepts(path, knowledge)
        report_work(knowledge, scene, given.clouds)
        report_loading(knowledge, path)
        if not given.offline:
            try:
                measure_graph(scene, path, given)
            except ImportError as error:
                print(f'ROS 2 cannot be imported ({error}): use --offline', file=sys.stderr)
                return 2
            except (InputError, EpisodeError) as error:
                print(error, file=sys.stderr)
                return 1
    return 0


if __name__ == '__main__':
    sys.exit(main())
