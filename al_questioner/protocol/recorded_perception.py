"""Machine that stands in for perception with the scenes that were recorded."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from al_questioner.domain import InputError
from al_questioner.messages.documents import Document
from al_questioner.messages.stamps import stamp_of
from al_questioner.protocol.effects import Effects, Level, Publish, Report, Say
from al_questioner.protocol.machine import Machine
from al_questioner.protocol.topics import Replayed
from al_questioner.protocol.worlds import WORLD_MEMBERS

PRESSED = 'pressed'
"""Source of the keys that the person presses; the content is the key."""


class RecordedPerceptionMachine(Machine):
    """Answers every `turn` of a live learner with the `objects` of the recorded turn, under the live turn's stamp.

    Only the stamp is another one: recorded ones lie in the past, and a learner takes no scene from before its turn.

    Args:
        clouds: by turn, the message on `objects` that was recorded; at least one.
        world: the simulated world that was recorded, as documents have it; None if it was another one.
        count: returns the number of objects in such a message.
        others: returns the names of the other nodes that show objects now.

    Attributes:
        turn: the live turn that was answered last.
        over: whether it was told to quit, or failed.
        failure: why it must not go on.
    """

    publishes = ('objects',)

    def __init__(
        self,
        clouds: Mapping[int, bytes],
        world: Document | None,
        count: Callable[[bytes], int],
        others: Callable[[], Sequence[str]],
    ) -> None:
        super().__init__()
        self.turn = 0
        self.over = False
        self.failure: InputError | None = None
        self._clouds = clouds
        self._world = world
        self._count = count
        self._others = others
        self._strange_worlds: set[str] = set()
        self.on_document('turn', self._look)
        self.on_entry(PRESSED, self._press)

    def start(self) -> Effects:
        """Say what it waits for."""
        yield Report('waiting for a turn')

    def _press(self, key: str) -> Effects:
        """Quit, if the key stands for that."""
        self.over = self.over or key == 'q'
        yield from ()

    def _look(self, document: Document) -> Effects:
        others = self._others()
        if others:
            self.failure = InputError(f'{others[0]} shows objects, too; the learner would see now this, now that')
            self.over = True
        if self.over:
            return
        turn = document['turn']
        recorded = self._clouds.get(turn)
        if recorded is None:
            raise InputError(f'no scene of turn {turn} was recorded, the last is that of {max(self._clouds)}')
        yield from self._compare_worlds(document)
        yield Publish('objects', Replayed(recorded, stamp_of(document['stamp'])))
        self.turn = turn
        yield Report(f'turn {turn}: {self._count(recorded)} objects')

    def _compare_worlds(self, document: Document) -> Effects:
        """Say if the learner speaks of another world: a person can teach it nevertheless, the script cannot."""
        ours, theirs = self._world, document['world']
        if ours is None or theirs is None or document['episode_id'] in self._strange_worlds:
            return
        differing = [
            f'{name} {theirs[name]!r}, recorded {ours[name]!r}' for name in WORLD_MEMBERS if theirs[name] != ours[name]
        ]
        if differing:
            self._strange_worlds.add(document['episode_id'])
            yield Say(
                f'the learner has {"; ".join(differing)}: the scripted teacher would answer about other things',
                Level.WARNING,
            )
