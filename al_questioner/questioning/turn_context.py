"""State of a turn as a questioning strategy sees it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from itertools import takewhile

import numpy as np
from numpy.typing import NDArray

from al_questioner.concepts import ConceptLearner
from al_questioner.domain import Action, Costs, Outcome, QueryKind, QueryRecord, Scene
from al_questioner.questioning.candidates import candidates


class LastResult:
    """The last result of a costly computation: it is not repeated while what it is made from stays the same."""

    def __init__(self) -> None:
        self._made_from: tuple[object, ...] | None = None
        self._result = np.empty(0)

    def of(self, made_from: tuple[object, ...], compute: Callable[[], NDArray[np.float64]]) -> NDArray[np.float64]:
        """Return the result for what it is made from, computed if that is not what it was the last time."""
        if made_from != self._made_from:
            self._result, self._made_from = compute(), made_from
        return self._result


@dataclass(frozen=True, eq=False)
class TurnContext:
    """Learning state of section 2.1 of the paper, before the action of the turn.

    It refers to the episode's concepts and is valid until they change. Costly values are computed on first use.

    Attributes:
        turn: 1-based.
        spent: part of the budget that was spent so far.
        change_interval: turns between scene changes as the robot expects them: the window of the non-query time.
        non_query_turns: consecutive turns before this one in which nothing was asked.
        scene_turn: turn in which the present scene was first seen.
        history: the queries so far, in order.
        look_ahead: the look-ahead of the last turn that needed one, kept by the episode.
    """

    turn: int
    turns: int
    scene: Scene
    concepts: ConceptLearner
    budget: float
    spent: float
    costs: Costs
    change_interval: int
    non_query_turns: int
    scene_turn: int
    history: tuple[QueryRecord, ...]
    look_ahead: LastResult = field(default_factory=LastResult)

    @property
    def symbols(self) -> tuple[str, ...]:
        """Concepts to ground."""
        return self.concepts.symbols

    @property
    def turns_left(self) -> int:
        """Turns after this one."""
        return self.turns - self.turn

    @property
    def budget_left(self) -> float:
        """Budget before the action."""
        return max(0.0, self.budget - self.spent)

    @property
    def allowance(self) -> float:
        """Amount that may be spent in the present scene: after the k-th of K scenes, k/K of the budget in all."""
        scenes = math.ceil(self.turns / self.change_interval)
        number = (self.turn - 1) // self.change_interval + 1
        return self.budget * number / scenes - self.spent

    @cached_property
    def absent_symbols(self) -> frozenset[str]:
        """Symbols that the present scene does not contain, according to the teacher."""
        records = takewhile(lambda record: record.turn >= self.scene_turn, reversed(self.history))
        return frozenset(
            record.symbol
            for record in records
            if record.kind is QueryKind.DEMONSTRATION
            and record.outcome is Outcome.ANSWERED
            and record.object_id is None
            and record.symbol is not None
        )

    @cached_property
    def excluded_symbols(self) -> frozenset[str]:
        """Symbols that no object of the scene can have, since every view in it has another label."""
        if not self.labelled.all():
            return frozenset()
        return frozenset(self.symbols).difference(self.concepts.labels_of(self.scene))

    @cached_property
    def known_answers(self) -> frozenset[Action]:
        """Questions whose only possible answer is known already.

        Once every view in the scene has a label, these are the demonstration of a symbol with a single object here,
        and the label of a single object; and which things matter, once of every view it is known whether it does.
        """
        can_be_asked = self.costs.relevance is not None
        is_judged = can_be_asked and (self.labelled | self.concepts.matters(self.scene)).all()
        relevance = {Action(QueryKind.RELEVANCE)} if is_judged else set()
        if not self.labelled.all():
            return frozenset(relevance)
        named = self.concepts.labels_of(self.scene)
        shown = {Action(QueryKind.DEMONSTRATION, symbol=symbol) for symbol in self.symbols if named.count(symbol) == 1}
        alone = {Action(QueryKind.LABEL, object_id) for object_id in self.scene.object_ids if len(named) == 1}
        return frozenset(shown | alone | relevance)

    @cached_property
    def candidates(self) -> tuple[Action, ...]:
        """Actions that can be paid for and have several answers, in the order of `candidates.candidates`."""
        return candidates(self.scene, self.symbols, self.costs, self.budget_left)

    @cached_property
    def probabilities(self) -> NDArray[np.float64]:
        """Degrees q_y(x) of the scene, (|X|, |Y|)."""
        return self.concepts.predict_proba(self.scene.features)

    @cached_property
    def labelled(self) -> NDArray[np.bool_]:
        """Views that have been labelled already, (|X|,) booleans."""
        return self.concepts.is_labelled(self.scene)
