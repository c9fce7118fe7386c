"""Perceptions: one that answers each turn, as the simulated one does, and a camera that publishes all the time."""

from __future__ import annotations

import json
from types import SimpleNamespace
from typing import Any

import numpy as np

from al_questioner.domain import Scene
from al_questioner.messages.clouds import CloudTypes, cloud_of_scene, scene_of_cloud
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.topics import Look
from shared.bottle.chart import Chart
from shared.bottle.clocks import RobotClock
from shared.bottle.faults import Faults
from shared.bottle.network import Endpoint, Network
from shared.bottle.scheduler import Scheduler
from shared.bottle.table import FEATURES, SENTINEL, Table

TYPES = CloudTypes(cloud=SimpleNamespace, field=SimpleNamespace, octets=bytes)
PERIOD_S = 0.5
"""Seconds from one picture of the camera to the next."""
SECONDS_OF_A_SCENE = 12.0


def look_of(scene: Scene, stamp: int) -> Look:
    """Return a scene as the nodes hear it, by the way of a real point cloud."""
    return Look(stamp, 'table', lambda known: scene_of_cloud(cloud_of_scene(scene, SimpleNamespace(), TYPES), known))


def broken_look(stamp: int, share: float) -> Look:
    """Return a cloud that cannot be read, or holds what cannot be."""
    width = 3 if share < 0.5 else 0
    cloud = SimpleNamespace(width=width, height=1, fields=[], point_step=0, row_step=0, is_bigendian=False, data=b'')
    return Look(stamp, 'table', lambda known: scene_of_cloud(cloud, known))


class Camera:
    """Publishes what it sees all the time, under its own clock: noise, sentinels, an arm, an empty table."""

    def __init__(
        self,
        name: str,
        namespace: str,
        table: Table,
        clock: RobotClock,
        scheduler: Scheduler,
        network: Network,
        faults: Faults,
        chart: Chart,
    ) -> None:
        self._name, self._table, self._clock = name, table, clock
        self._scheduler, self._network, self._faults, self._chart = scheduler, network, faults, chart
        self._glances = 0
        self._endpoint = Endpoint(name, namespace, is_volatile=True)
        network.join(self._endpoint)
        scheduler.after(PERIOD_S, self._see)

    def _see(self) -> None:
        self._scheduler.after(PERIOD_S, self._see)
        name = (self._name, self._glances)
        self._glances += 1
        glance, happens = self._glances, self._faults.happens
        number = int(self._scheduler.now / SECONDS_OF_A_SCENE)
        stamp = self._clock.nanoseconds
        if happens('no picture', *name):
            return
        if happens('broken cloud', *name):
            self._publish(broken_look(stamp, self._faults.draw('which cloud', *name)))
            return
        if happens('empty table', *name):
            nothing = np.empty((0, 3), np.float32), np.empty((0, len(FEATURES)), np.float32)
            self._publish(look_of(Scene((), *nothing, FEATURES), stamp))
            return
        hides = happens('arm', *name)
        reads_nothing = happens('sentinel', *name)
        self._table.has_misread |= reads_nothing

        def read(known: Any) -> Scene:
            scene = self._table.seen(number, glance)
            features = scene.features.copy()
            if reads_nothing:
                features[0, 0] = SENTINEL
            kept = slice(len(scene) // 2 if hides else 0, None)
            seen = Scene(scene.object_ids[kept], scene.positions[kept], features[kept], scene.feature_names)
            return look_of(seen, stamp).read(known)

        self._publish(Look(stamp, 'table', read))

    def _publish(self, look: Look) -> None:
        self._network.publish(self._endpoint, 'objects', look)
        # A camera does not latch.
        self._endpoint.latched.clear()


class TurnPerception:
    """Answers each turn with its scene under the stamp of the turn; it latches, and can be killed."""

    def __init__(
        self,
        name: str,
        namespace: str,
        table: Table,
        interval: int,
        scheduler: Scheduler,
        network: Network,
        faults: Faults,
        chart: Chart,
    ) -> None:
        self._name, self._namespace, self._table, self._interval = name, namespace, table, interval
        self._scheduler, self._network, self._faults, self._chart = scheduler, network, faults, chart
        self._heard = 0
        self._start()

    def _start(self) -> None:
        self._endpoint = Endpoint(self._name, self._namespace, {'turn': self._look})
        self._network.join(self._endpoint)

    def _look(self, text: str) -> None:
        self._heard += 1
        if self._faults.happens('death', self._name, self._heard):
            self._chart.note(self._name, 'DIES')
            self._network.leave(self._endpoint)
            self._scheduler.after(5.0 * self._faults.draw('down', self._name, self._heard), self._start)
            return
        document, endpoint = json.loads(text), self._endpoint
        scene = self._table.scene((document['turn'] - 1) // self._interval)
        look = look_of(scene, stamp_of(document['stamp']))

        def publish() -> None:
            if endpoint.is_alive:
                self._network.publish(endpoint, 'objects', look)

        self._scheduler.after(0.01, publish)
