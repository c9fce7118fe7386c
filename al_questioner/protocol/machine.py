"""The base of all machines: who hears what, timers by name, and refusals."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from al_questioner.domain import InputError
from al_questioner.messages import documents
from al_questioner.messages.documents import Document
from al_questioner.protocol.effects import Effects, Publish, Refuse
from al_questioner.protocol.events import Entered, Event, Heard, Moment, Now, TimerFired


class Machine:
    """The behaviour of a node. It knows no thread, no middleware and no clock; the caller performs its effects.

    A handler is a generator of effects. The caller performs each effect before asking for the next, so that what
    follows an effect happens only if the effect did. If a handler cannot use what was heard it raises an InputError:
    that is refused, and the machine goes on. Any other error is the caller's.

    Attributes:
        publishes: topics on which it may publish.
        episode_id: of the documents that it writes.
        now: the time, each time it is read, as the event's handler was given it: see `Now`.
    """

    publishes: ClassVar[tuple[str, ...]] = ()

    def __init__(self, episode_id: str = '') -> None:
        self.episode_id = episode_id
        self.now: Now = Moment()
        self._hearers: dict[str, Callable[[Any], Effects]] = {}
        self._alarms: dict[str, Callable[[], Effects]] = {}
        self._entries: dict[str, Callable[[Any], Effects]] = {}

    @property
    def subscribes(self) -> tuple[str, ...]:
        """Topics that it listens to."""
        return tuple(self._hearers)

    def handle(self, event: Event, now: Now) -> Effects:
        """Handle an event that happens now; the effects are to be performed one by one."""
        self.now = now
        if isinstance(event, Heard):
            try:
                yield from self._hearers[event.topic](event.content)
            except InputError as error:
                yield Refuse(event.topic, str(error))
        elif isinstance(event, TimerFired):
            yield from self._alarms[event.timer]()
        elif isinstance(event, Entered):
            yield from self._entries[event.source](event.content)
        else:
            yield from self.start()

    def start(self) -> Effects:
        """Do what comes first."""
        yield from ()

    def on(self, topic: str, handler: Callable[[Any], Effects]) -> None:
        """Have a handler called with what is heard on a topic."""
        self._hearers[topic] = handler

    def on_document(self, kind: str, handler: Callable[[Document], Effects]) -> None:
        """Have a handler called with every valid document of the topic of its kind."""
        self.on(kind, lambda text: handler(documents.read(kind, text)))

    def on_timer(self, timer: str, handler: Callable[[], Effects]) -> None:
        """Have a handler called when a timer rings."""
        self._alarms[timer] = handler

    def on_entry(self, source: str, handler: Callable[[Any], Effects]) -> None:
        """Have a handler called with what a person does at this process."""
        self._entries[source] = handler

    def document(self, kind: str, members: Document) -> Publish:
        """Return the publication of a document of the present episode on the topic of its kind."""
        return Publish(kind, documents.write(kind, self.episode_id, members))

    def warning(self, now: Now) -> str:
        """Return a warning about what surrounds the node, for /diagnostics; empty if there is none.

        It may be asked by another thread than that which handles events.
        """
        return ''

    def close(self) -> None:
        """Let go of what it holds; no event comes any more."""

    def counts(self) -> Mapping[str, int]:
        """Return what is to be counted on /diagnostics; another thread may ask."""
        return {}

    def measurements(self) -> Mapping[str, str]:
        """Return what is to be told in words on /diagnostics; another thread may ask."""
        return {}
