"""One episode that a bag holds, as the learner lived it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

from al_questioner.domain import Decision, QueryRecord, Scene
from al_questioner.event_log.events import ActionChosen, EpisodeEvent, EpisodeStarted, SceneObserved


class RecordedTurn(NamedTuple):
    """One turn that is over.

    Attributes:
        turn: 1-based.
        decision: what was weighed and chosen; its query is None.
        record: what was asked, and answered in the end; None if nothing was.
    """

    turn: int
    scene: Scene
    decision: Decision
    record: QueryRecord | None


@dataclass(frozen=True, eq=False)
class RecordedEpisode:
    """One recorded episode, or its first turns if the recording ended before it did.

    Attributes:
        source: the bag.
        events: what followed its beginning, see `bags.events`.
        turns_over: turns whose end was recorded, from the first on, without a gap.
        records: what came of their queries in the end, in the order of their turns.
    """

    source: Path
    started: EpisodeStarted
    feature_names: tuple[str, ...]
    events: tuple[EpisodeEvent, ...]
    turns_over: int
    records: tuple[QueryRecord, ...]

    @property
    def decisions(self) -> int:
        """Number of decisions that were recorded, that of a turn included whose end was not."""
        return sum(isinstance(event, ActionChosen) for event in self.events)

    @cached_property
    def turns(self) -> tuple[RecordedTurn, ...]:
        """The turns whose end was recorded."""
        scenes = [event.scene for event in self.events if isinstance(event, SceneObserved)]
        decisions = [event.weighed for event in self.events if isinstance(event, ActionChosen)]
        records = {record.turn: record for record in self.records}
        return tuple(
            RecordedTurn(turn, scene, decision, records.get(turn))
            for turn, scene, decision in zip(range(1, self.turns_over + 1), scenes, decisions, strict=False)
            if decision is not None
        )

    @property
    def change_turns(self) -> tuple[int, ...]:
        """Turns whose scene differs from that of the turn before."""
        looks = [(turn.scene.object_ids, turn.scene.features.tobytes()) for turn in self.turns]
        return tuple(
            turn.turn for turn, look, last in zip(self.turns[1:], looks[1:], looks, strict=False) if look != last
        )
