"""Driver of a machine without ROS: a clock that only the test moves, and a list of what the machine wanted done."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any, TypeVar

from al_questioner.messages import documents
from al_questioner.messages.stamps import SECOND
from al_questioner.protocol.effects import ClearTimer, Effect, Effects, Publish, Refuse, Report, Say, SetTimer
from al_questioner.protocol.events import Entered, Event, Heard, Moment, Started, TimerFired
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.performing import perform_all

Kind = TypeVar('Kind')

CLOCK_AT_START = 1000 * SECOND
"""Time that the clock of the robot shows when the steady clock shows 0."""


class Driver:
    """Stands for the node around a machine.

    Args:
        machine: the machine under test.
        do: does an effect, if the test wants it done; its error goes back to the machine.

    Attributes:
        seconds: of the steady clock.
        done: the time of each effect, and the effect, in order.
        timers: when each timer that is set will ring.
    """

    def __init__(self, machine: Machine, do: Callable[[Effect], None] = lambda _: None) -> None:
        self.machine = machine
        self.seconds = 0.0
        self.done: list[tuple[float, Effect]] = []
        self.timers: dict[str, float] = {}
        self._do = do

    @property
    def now(self) -> Moment:
        """The present time."""
        return Moment(self.seconds, CLOCK_AT_START + round(self.seconds * SECOND))

    def start(self) -> None:
        """Begin."""
        self.tell(Started())

    def hear(self, topic: str, content: Any) -> None:
        """Have the machine hear something."""
        self.tell(Heard(topic, content))

    def hear_document(self, kind: str, episode_id: str, members: dict[str, Any]) -> None:
        """Have the machine hear a document on the topic of its kind."""
        self.hear(kind, documents.write(kind, episode_id, members))

    def enter(self, source: str, content: Any) -> None:
        """Have the machine hear of what a person did."""
        self.tell(Entered(source, content))

    def tell(self, event: Event) -> None:
        """Have the machine handle an event."""
        self.perform(self.machine.handle(event, self.now))

    def perform(self, effects: Effects) -> None:
        """Perform effects one by one."""
        perform_all(effects, self._perform)

    def pass_until(self, end: float) -> None:
        """Let time pass, and the timers ring that are due."""
        while self.timers:
            timer = min(self.timers, key=self.timers.__getitem__)
            if self.timers[timer] > end:
                break
            self.seconds = self.timers.pop(timer)
            self.tell(TimerFired(timer))
        self.seconds = end

    def effects(self, kind: type[Kind]) -> list[Kind]:
        """Return all effects of a kind, in order."""
        return [effect for _, effect in self.done if isinstance(effect, kind)]

    def published(self, topic: str) -> list[Any]:
        """Return all that was said on a topic; documents already parsed."""
        found = [effect.content for effect in self.effects(Publish) if effect.topic == topic]
        return [json.loads(one) if isinstance(one, str) else one for one in found]

    @property
    def refusals(self) -> list[tuple[str, str]]:
        """Topic and reason of each refusal."""
        return [(effect.topic, effect.reason) for effect in self.effects(Refuse)]

    @property
    def status(self) -> str:
        """The activity that was reported last."""
        return self.effects(Report)[-1].activity

    @property
    def lines(self) -> list[str]:
        """The lines of the log."""
        return [effect.text for effect in self.effects(Say)]

    def _perform(self, effect: Effect) -> None:
        self.done.append((self.seconds, effect))
        if isinstance(effect, SetTimer):
            # Set last, so that of two timers of one time the one that was set first rings first.
            self.timers.pop(effect.timer, None)
            self.timers[effect.timer] = self.seconds + effect.seconds
        elif isinstance(effect, ClearTimer):
            self.timers.pop(effect.timer, None)
        self._do(effect)
