"""Recognition on a table that the robot has not seen: what the demo ends with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from al_questioner.concepts.recognition import Recogniser
from al_questioner.domain import NO_SYMBOL, RecognisedThing, Recognition
from al_questioner.questioning.scene_recogniser import recognise_scene
from al_questioner.simulation import Evaluation, PerceivedWorld
from al_questioner.simulation.world import Table


@dataclass(frozen=True, eq=False)
class NewTable:
    """A table that the robot has not seen, and what the robot takes the things on it for.

    Attributes:
        table: what is really there.
        recognition: by what the robot was taught.
    """

    table: Table
    recognition: Recognition

    def is_right(self, thing: RecognisedThing) -> bool:
        """Return whether a thing is known, and is what it is taken for."""
        return thing.is_known and thing.best == self.table.symbols[thing.object_id]

    @property
    def right(self) -> tuple[RecognisedThing, ...]:
        """Things that are recognised."""
        return tuple(filter(self.is_right, self.recognition.things))

    def members(self) -> dict[str, Any]:
        """Return the numbers for a document."""
        things = self.recognition.things
        return {
            'things': len(things),
            'recognised': len(self.right),
            'of_some_symbol': sum(symbol != NO_SYMBOL for symbol in self.table.symbols.values()),
            'named_rightly': sum(thing.best != NO_SYMBOL for thing in self.right),
            'named': sum(thing.is_known and thing.best != NO_SYMBOL for thing in things),
            'not_known': sum(not thing.is_known for thing in things),
        }

    def __str__(self) -> str:
        counts = self.members()
        text = f'It recognises {counts["recognised"]} of {counts["things"]} things on a table it has not seen'
        if counts['of_some_symbol'] in (0, counts['things']):
            return f'{text}.'
        named = f'{counts["named_rightly"]} of the {counts["of_some_symbol"]} that have a name'
        others = counts['recognised'] - counts['named_rightly']
        return f'{text}: {named}, {others} of the {counts["things"] - counts["of_some_symbol"]} that have none.'


def recognise_new_table(evaluation: Evaluation, world: PerceivedWorld) -> NewTable:
    """Have the learner of an episode recognise a held-out table of its world.

    Raises:
        InputError: the world has nothing that can be laid on one.
    """
    scene, table = world.new_table()
    return NewTable(table, recognise_scene(Recogniser(evaluation.concepts), scene))
