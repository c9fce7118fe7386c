"""The topics of all robots: delay, loss, duplicates, another order, latched messages of depth 1, late listeners."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from al_questioner.protocol.topics import TOPICS, Delivery
from shared.bottle.chart import Chart
from shared.bottle.faults import Faults
from shared.bottle.scheduler import Scheduler

SHORTEST_DELAY_S, LONGEST_DELAY_S = 0.0005, 0.004
LONG_DELAY_S = 3.0
"""Delay of a message that a fault holds up."""


@dataclass
class Endpoint:
    """One process on the network, from its start to its death.

    Attributes:
        name: of the process, with its namespace.
        hear: takes topic and content of each message, by topic.
        is_best_effort: whether it neither repeats what is lost nor keeps anything for late listeners, as cameras do.
    """

    name: str
    namespace: str
    hear: dict[str, Callable[[Any], None]] = field(default_factory=dict)
    latched: dict[str, Any] = field(default_factory=dict)
    is_best_effort: bool = False
    is_alive: bool = True


class Network:
    """Carries messages between endpoints of one namespace.

    Attributes:
        endpoints: the processes that take part.
        published: topic and text of everything that was said.
    """

    def __init__(self, scheduler: Scheduler, faults: Faults, chart: Chart) -> None:
        self._scheduler, self._faults, self._chart = scheduler, faults, chart
        self.endpoints: list[Endpoint] = []
        self.published: set[tuple[str, str]] = set()
        self._sent: Counter[tuple[str, str, str]] = Counter()
        self._last_arrival: dict[tuple[str, str, str], float] = {}

    def join(self, endpoint: Endpoint) -> None:
        """Have a process take part; it gets what others have latched."""
        self.endpoints.append(endpoint)
        for other in self.endpoints[:-1]:
            if other.namespace == endpoint.namespace and not other.is_best_effort:
                for topic, content in other.latched.items():
                    if topic in endpoint.hear:
                        self._carry(other, endpoint, topic, content)

    def leave(self, endpoint: Endpoint) -> None:
        """Take a process out; what it latched is gone, and what is under way to it is lost."""
        endpoint.is_alive = False
        self.endpoints.remove(endpoint)

    def publish(self, sender: Endpoint, topic: str, content: Any) -> None:
        if TOPICS[topic] is Delivery.LATCHED:
            sender.latched[topic] = content
        if isinstance(content, str):
            self.published.add((topic, content))
        # A node hears itself, too.
        for one in self.endpoints:
            if one.namespace == sender.namespace and topic in one.hear:
                self._carry(sender, one, topic, content)

    def _carry(self, sender: Endpoint, one: Endpoint, topic: str, content: Any) -> None:
        link = (sender.name, one.name, topic)
        number = self._sent[link]
        self._sent[link] += 1
        name = (*link, number)
        faults = self._faults
        if faults.happens('loss', *name) or (sender.is_best_effort and faults.happens('best effort', *name)):
            self._chart.lost(sender.name, one.name, topic, content)
            return
        self._deliver(sender, one, topic, content, link, number, self._delay(*name))
        if faults.happens('duplicate', *name):
            self._deliver(sender, one, topic, content, link, number, self._delay('again', *name))

    def _delay(self, *name: object) -> float:
        usual = SHORTEST_DELAY_S + (LONGEST_DELAY_S - SHORTEST_DELAY_S) * self._faults.draw('delay', *name)
        return usual + (
            LONG_DELAY_S * self._faults.draw('how long', *name) if self._faults.happens('delay', *name) else 0
        )

    def _deliver(
        self,
        sender: Endpoint,
        one: Endpoint,
        topic: str,
        content: Any,
        link: tuple[str, str, str],
        number: int,
        delay: float,
    ) -> None:
        at = self._scheduler.now + delay
        if not self._faults.happens('reorder', *link, number, round(delay, 6)):
            at = max(at, self._last_arrival.get(link, 0.0))
            self._last_arrival[link] = at
        sent_at = self._scheduler.now

        def arrive() -> None:
            if one.is_alive:
                self._chart.arrived(sender.name, one.name, topic, content, sent_at)
                one.hear[topic](content)

        self._scheduler.after(at - self._scheduler.now, arrive)
