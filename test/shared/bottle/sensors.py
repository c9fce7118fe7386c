"""A camera that publishes all the time."""

from __future__ import annotations

from typing import Any

import numpy as np

from al_questioner.domain import Scene
from al_questioner.protocol.topics import Look
from shared.bottle.chart import Chart
from shared.bottle.clocks import RobotClock
from shared.bottle.faults import Faults
from shared.bottle.looks import broken_look, look_of
from shared.bottle.network import Endpoint, Network
from shared.bottle.scheduler import Scheduler
from shared.bottle.table import FEATURES, OTHER_IDS, SENTINEL, Table

PERIOD_S = 1.0
"""Seconds from one picture of the camera to the next."""
SECONDS_OF_A_SCENE = 12.0


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
        self._endpoint = Endpoint(name, namespace, is_best_effort=True)
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
        bursts = happens('burst', *name)
        flickers = happens('another id', *name)
        self._table.has_misread |= reads_nothing or bursts

        def read(known: Any) -> Scene:
            scene = self._table.seen(number, glance)
            features = scene.features.copy()
            if reads_nothing:
                features[0, 0] = SENTINEL
            if bursts:
                features += np.float32(3.0) * self._table.seen(number, -glance).features
            ids = list(scene.object_ids)
            if flickers:
                ids[-1] += OTHER_IDS
            kept = slice(len(scene) // 2 if hides else 0, None)
            seen = Scene(tuple(ids[kept]), scene.positions[kept], features[kept], scene.feature_names)
            return look_of(seen, stamp).read(known)

        self._publish(Look(stamp, 'table', read))

    def _publish(self, look: Look) -> None:
        self._network.publish(self._endpoint, 'objects', look)
        # A camera does not latch.
        self._endpoint.latched.clear()
